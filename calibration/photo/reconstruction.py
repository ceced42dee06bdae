"""All photographs of an experiment traced, and the experiment again with outlines in their place."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from posixpath import normpath
from typing import Any

from calibration._files import on_any_disk, write_whole
from calibration.errors import InputError
from calibration.experiment import BeamTrial, Checkerboard, PhotoSettings, load, read, read_photo_settings
from calibration.photo._board import Board, find_board
from calibration.photo._camera import Camera, calibrate
from calibration.photo._chain import LEDGER, REPORT, Job, digest, kept, note_source, other_source, run
from calibration.photo._files import named_files, outline_name, png, write_copy
from calibration.photo._image import PhotoProblem, UnusablePhotographs, read_photograph
from calibration.progress import OnProgress, Progress, to_log
from calibration.results import Reconstruction


def reconstruct(
    experiment: Path,
    *,
    out: Path | None = None,
    resume: bool = True,
    skip_bad: bool = False,
    on_progress: OnProgress = to_log,
) -> Reconstruction:
    """Trace every photograph; see `calibration.reconstruct`."""
    read_in, settings = read(experiment), read_photo_settings(experiment)
    target = out or Path(f"{experiment.resolve().name}-traced")
    _check_target(target, experiment, read_in.name, resume=resume)
    jobs = [
        Job(name=f"{trial.id}-{number + 1}".replace("/", "-"), trial=trial, number=number, capture=capture)
        for trial in read_in.trials
        if isinstance(trial, BeamTrial)
        for number, capture in enumerate(trial.captures)
    ]
    if not jobs:
        raise InputError(f"{experiment}: expected a beam with captures, it has none")
    _check_names(jobs, experiment)
    work = _Work()
    _find_boards(jobs, experiment, settings, work, on_progress)
    if work.problems.keys() != {job.name for job in jobs}:
        note_source(target, experiment, read_in.name)
    _run_all(jobs, target, settings, work, on_progress, resume=resume)
    return _finish(jobs, experiment, target, work, skip_bad=skip_bad)


@dataclass
class _Work:
    """Boards and cameras by photograph; captures that failed, with their sentences; whether pictures of what
    was found in some of these were written."""

    boards: dict[str, Board] = field(default_factory=dict)
    cameras: dict[str, Camera] = field(default_factory=dict)
    problems: dict[str, str] = field(default_factory=dict)
    shown: bool = False
    figures: dict[str, dict[str, Any]] = field(default_factory=dict)


def _check_target(target: Path, experiment: Path, name: str, *, resume: bool) -> None:
    if target.exists() and not target.is_dir():
        raise InputError(f"{target}: expected a folder to write to, it is a file")
    if target.resolve() == experiment.resolve():
        raise InputError(f"{target}: expected a folder other than the experiment's own")
    if (target / "experiment.yaml").exists() and not (target / LEDGER).is_dir():
        raise InputError(f"{target}: holds an experiment that this command did not write")
    if resume and (other := other_source(target, experiment, name)) is not None:
        raise InputError(
            f"--out {target}: holds the traced experiment {other}: choose another folder, or add --overwrite"
            " to replace it"
        )


def _check_names(jobs: list[Job], experiment: Path) -> None:
    """Refuse a file of the experiment with the name of an outline that is to be traced: both go into one
    folder, and the experiment written there would take the one for the other."""
    main = experiment / "experiment.yaml"
    theirs: dict[str, str] = {}
    for name in sorted(named_files(load(main.read_bytes(), main))):
        other = theirs.setdefault(on_any_disk(normpath(name)), name)
        if normpath(other) != normpath(name):
            raise InputError(
                f"{main}: {name}: expected a name that differs in more than letter case from that of {other}"
            )
    for job in jobs:
        if not job.traced and (name := on_any_disk(outline_name(job.name))) in theirs:
            raise InputError(
                f"{main}: {theirs[name]}: expected another name of this file, it is that of the outline"
                f" traced from {job.name}"
            )


def _find_boards(
    jobs: list[Job], folder: Path, settings: PhotoSettings, work: _Work, on_progress: OnProgress
) -> None:
    """All boards first: photographs of one size share a camera, and calibrate it together."""
    wanted = [job for job in jobs if not job.traced]
    total, done = len(wanted) + len(settings.calibration_photos), 0
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
        done += 1
        on_progress(Progress(message=f"{job.name}: board", done=done, total=total))
    for name in settings.calibration_photos:
        if len(boards) != 1:
            raise InputError(f"{folder / 'photographs.yaml'}: calibration_photos: expected one kind of board")
        try:
            board = find_board(read_photograph(folder / name), next(iter(boards)))
        except PhotoProblem as error:
            raise InputError(f"{folder / name}: {error}") from None
        if work.boards and board.size not in views:
            sizes = " or ".join(f"{w} x {h}" for w, h in views)
            raise InputError(
                f"{folder / name}: expected a photograph of {sizes} pixels, as those of the specimens are, it"
                f" is {board.size[0]} x {board.size[1]}: it says nothing of their lens"
            )
        views.setdefault(board.size, []).append(board)
        done += 1
        on_progress(Progress(message=f"{name}: board", done=done, total=total))
    for size, found in views.items():
        same = [job for job in wanted if job.name in work.boards and work.boards[job.name].size == size]
        try:
            camera = calibrate(found)
        except InputError as error:  # the others may still be traced
            for job in same:
                del work.boards[job.name]
                work.problems[job.name] = _sentence(job, error)
                work.figures[job.name] = {"picture": None}
        else:
            work.cameras |= {job.name: camera for job in same}


def _run_all(
    jobs: list[Job],
    target: Path,
    settings: PhotoSettings,
    work: _Work,
    on_progress: OnProgress,
    *,
    resume: bool,
) -> None:
    for number, job in enumerate(jobs, 1):
        outcome = "cannot be used"
        if job.name not in work.problems:
            board, camera = work.boards.get(job.name), work.cameras.get(job.name)
            key = digest(job, board, camera, settings)
            done = kept(target, job, key) if resume else None
            try:
                if done is None:  # until all is done again, no experiment names outlines that change
                    (target / "experiment.yaml").unlink(missing_ok=True)
                work.figures[job.name] = done or run(target, job, key, board, camera, settings)
                outcome = "kept" if done else "done"
            except InputError as error:
                work.problems[job.name] = _sentence(job, error)
                work.figures[job.name] = {"picture": getattr(error, "picture", None)}
        if job.name in work.problems:
            picture = work.figures.pop(job.name)["picture"]
            if picture is not None:
                write_whole(target / "problems" / f"{job.name}.png", png(picture))
                work.shown = True
        on_progress(Progress(message=f"{job.name}: {outcome}", done=number, total=len(jobs)))


def _sentence(job: Job, error: InputError) -> str:
    place = job.capture.photo.name if job.capture.photo is not None else "its outline"
    return f"{job.name} ({place}): {error}"


def _finish(jobs: list[Job], folder: Path, target: Path, work: _Work, *, skip_bad: bool) -> Reconstruction:
    if work.problems and not skip_bad:
        shown = f" (pictures of what was found in {target / 'problems'})" if work.shown else ""
        raise UnusablePhotographs(
            f"{len(work.problems)} of {len(jobs)} captures cannot be used{shown}; {len(work.figures)} are"
            " traced and kept; take them again, or leave them out with --skip-bad",
            work.problems,
        )
    for job in jobs:
        old = target / "problems" / f"{job.name}.png"
        if job.name in work.figures and old.exists():
            old.unlink()
    by_place = {(job.trial.id, job.number): job.name for job in jobs}
    figures = {place: work.figures[name] for place, name in by_place.items() if name in work.figures}
    try:
        write_copy(folder, target, figures, by_place)
    except InputError as error:
        if not work.problems:
            raise
        raise UnusablePhotographs(str(error), work.problems) from None
    report = {"experiment": folder.resolve().name, "captures": work.figures, "left_out": work.problems}
    write_whole(target / REPORT, json.dumps(report, indent=1).encode())
    # what was written is an experiment
    return Reconstruction(target, read(target), dict(work.figures), dict(work.problems))
