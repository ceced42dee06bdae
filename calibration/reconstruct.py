"""`python -m calibration.reconstruct`: from photographs to outlines, mid lines and bodies."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from calibration._command import plain_ends
from calibration.errors import InputError
from calibration.experiment import BeamTrial, Checkerboard, read
from calibration.photo import (
    Board,
    Camera,
    PhotoProblem,
    PhotoSettings,
    calibrate,
    find_board,
    read_photograph,
    read_settings,
)
from calibration.photo._chain import LEDGER, Job, digest, kept, run
from calibration.photo._copy import write_copy
from calibration.photo._files import png, write_whole

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Examples[/bold]

  python -m calibration.reconstruct lab/monday --out work/monday

  python -m calibration.fit work/monday

How to photograph: docs/photographs.md. Stopped or killed, the same command goes on where it was.

Exit codes: 0 done, 2 bad input or photographs that cannot be used, 130 stopped by Ctrl-C.
"""


@dataclass
class _Work:
    """Boards and cameras by photograph; captures that failed, with their sentences."""

    boards: dict[str, Board] = field(default_factory=dict)
    cameras: dict[str, Camera] = field(default_factory=dict)
    problems: dict[str, str] = field(default_factory=dict)
    figures: dict[str, dict[str, Any]] = field(default_factory=dict)


@app.command(epilog=EXAMPLES)
@plain_ends("Stopped: what is traced is kept; the same command goes on.")
def main(
    experiment: Annotated[Path, typer.Argument(help="Folder with experiment.yaml (format 1).")],
    out: Annotated[
        Path | None, typer.Option(help="Folder to write. Default: EXPERIMENT's name with -traced, here.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume/--overwrite", help="Keep what is already traced, or trace all again.")
    ] = True,
    skip_bad: Annotated[
        bool,
        typer.Option("--skip-bad", help="Leave out photographs that cannot be used, instead of stopping."),
    ] = False,
) -> None:
    """Traces every photograph of an experiment: outline, mid line, swept body and a strip of pictures each,
    and an experiment.yaml that names the outlines."""
    console = Console(soft_wrap=True, width=None if sys.stdout.isatty() else 140)
    read_in, settings = read(experiment), read_settings(experiment)
    target = out or Path(f"{experiment.resolve().name}-traced")
    _check_target(target, experiment)
    jobs = [
        Job(name=f"{trial.id}-{number + 1}".replace("/", "-"), trial=trial, number=number, capture=capture)
        for trial in read_in.trials
        if isinstance(trial, BeamTrial)
        for number, capture in enumerate(trial.captures)
    ]
    if not jobs:
        raise InputError(f"{experiment}: expected a beam with captures, it has none")
    work = _Work()
    with _progress(console) as bar:
        _find_boards(jobs, experiment, settings, work, bar)
        _run_all(jobs, target, settings, work, bar, resume=resume, console=console)
    _finish(jobs, experiment, target, work, skip_bad=skip_bad, console=console)


def _check_target(target: Path, experiment: Path) -> None:
    if target.exists() and not target.is_dir():
        raise InputError(f"{target}: expected a folder to write to, it is a file")
    if target.resolve() == experiment.resolve():
        raise InputError(f"{target}: expected a folder other than the experiment's own")
    if (target / "experiment.yaml").exists() and not (target / LEDGER).is_dir():
        raise InputError(f"{target}: holds an experiment that this command did not write")


def _progress(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
        disable=not console.is_terminal,
    )


def _find_boards(jobs: list[Job], folder: Path, settings: PhotoSettings, work: _Work, bar: Progress) -> None:
    """All boards first: photographs of one size share a camera, and calibrate it together."""
    wanted = [job for job in jobs if not job.traced]
    task = bar.add_task("boards", total=len(wanted) + len(settings.calibration_photos))
    views: dict[tuple[int, int], list[Board]] = {}
    boards: set[Checkerboard] = set()
    for job in wanted:
        assert job.capture.photo is not None
        assert job.capture.checkerboard is not None
        boards.add(job.capture.checkerboard)
        try:
            board = find_board(read_photograph(job.capture.photo), job.capture.checkerboard)
        except InputError as error:
            work.problems[job.name] = _sentence(job, error)
            work.figures[job.name] = {"picture": getattr(error, "picture", None)}
        else:
            work.boards[job.name] = board
            views.setdefault(board.size, []).append(board)
        bar.advance(task)
    for name in settings.calibration_photos:
        if len(boards) != 1:
            raise InputError(f"{folder / 'photographs.yaml'}: calibration_photos: expected one kind of board")
        try:
            board = find_board(read_photograph(folder / name), next(iter(boards)))
        except PhotoProblem as error:
            raise InputError(f"{folder / name}: {error}") from None
        views.setdefault(board.size, []).append(board)
        bar.advance(task)
    cameras = {size: calibrate(found) for size, found in views.items()}
    work.cameras = {name: cameras[board.size] for name, board in work.boards.items()}


def _run_all(
    jobs: list[Job],
    target: Path,
    settings: PhotoSettings,
    work: _Work,
    bar: Progress,
    *,
    resume: bool,
    console: Console,
) -> None:
    task = bar.add_task("captures", total=len(jobs))
    for job in jobs:
        if job.name not in work.problems:
            board, camera = work.boards.get(job.name), work.cameras.get(job.name)
            key = digest(job, board, camera, settings)
            done = kept(target, job, key) if resume else None
            try:
                if done is None:  # until all is done again, no experiment names outlines that change
                    (target / "experiment.yaml").unlink(missing_ok=True)
                work.figures[job.name] = done or run(target, job, key, board, camera, settings)
                if not console.is_terminal:
                    console.print(f"{job.name}: {'kept' if done else 'done'}", markup=False)
            except InputError as error:
                work.problems[job.name] = _sentence(job, error)
                work.figures[job.name] = {"picture": getattr(error, "picture", None)}
        if job.name in work.problems:
            picture = work.figures.pop(job.name)["picture"]
            if picture is not None:
                write_whole(target / "problems" / f"{job.name}.png", png(picture))
        bar.advance(task)


def _sentence(job: Job, error: InputError) -> str:
    place = job.capture.photo.name if job.capture.photo is not None else "its outline"
    return f"{job.name} ({place}): {error}"


def _finish(
    jobs: list[Job], folder: Path, target: Path, work: _Work, *, skip_bad: bool, console: Console
) -> None:
    for sentence in work.problems.values():
        typer.echo(f"error: {sentence}", err=True)
    if work.problems and not skip_bad:
        raise InputError(
            f"{len(work.problems)} of {len(jobs)} captures cannot be used (pictures of what was found in "
            f"{target / 'problems'}); {len(work.figures)} are traced and kept; take them again, or leave "
            "them out with --skip-bad"
        )
    for job in jobs:
        old = target / "problems" / f"{job.name}.png"
        if job.name in work.figures and old.exists():
            old.unlink()
    by_place = {(job.trial.id, job.number): job.name for job in jobs}
    figures = {place: work.figures[name] for place, name in by_place.items() if name in work.figures}
    dropped = write_copy(folder, target, figures, by_place)
    report = {"experiment": folder.name, "captures": work.figures, "left_out": work.problems}
    write_whole(target / "reconstruct.json", json.dumps(report, indent=1).encode())
    read(target)  # what was written is an experiment
    console.print(_table(work.figures))
    left = f", {dropped} left out" if dropped else ""
    console.print(
        f"{target}: {len(figures)} captures{left}; python -m calibration.fit {target}", markup=False
    )


def _table(figures: dict[str, dict[str, Any]]) -> Table:
    table = Table(title="Captures")
    for column in ("capture", "mm/px", "tilt deg", "height mm", "outline sd mm", "shift sd mm", "scale sd"):
        table.add_column(column, justify="left" if column == "capture" else "right")
    for name, f in figures.items():
        traced = "mm_per_pixel" in f
        own = (
            [f"{f['mm_per_pixel']:.4f}", f"{f['tilt_deg']:.1f}", f"{f['diameter_mm']:.3f}"]
            if traced
            else 3 * ["-"]
        )
        registration = f["registration_sd"]
        table.add_row(
            name,
            *own,
            f"{f['outline_sd_mm']:.4f}",
            f"{registration['shift_mm']:.3f}",
            f"{registration['scale']:.4f}",
        )
    return table


if __name__ == "__main__":
    app()
