"""Output of the build command: the plan, progress with the time left, and the preview picture."""

from __future__ import annotations

import io
import logging
import time
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from factory.building.build import BuildProgress, Built, check_continues, is_built
from factory.cli import duration, sides_text, size_text
from factory.errors import InputError, describe_os_error
from factory.materials.effects import TAKEN
from factory.materials.parts import part_entries
from factory.plan.dataset import Plan
from factory.recipe.course import HoldRecipe, deepest
from factory.simulation.record import Trace
from factory.store.files import manifest_digest, read_ledger
from factory.store.staging import Staging
from tisim.parallel.termination import uninterrupted
from tisim.problems._stops import shortest_time
from tisim.problems.indentation.steps import LARGEST_STEP

if TYPE_CHECKING:
    from factory.reader import Dataset

log = logging.getLogger(__name__)
_LINE_SECONDS = 20.0  # between lines where the output is no terminal
_PICTURE_SECONDS = 120.0

# Measured with Ogden on 2 cores: 18.5 core-s per solve to 20 mm over inclusions (datasets/cards/paper-ogden),
# a third of that to 10 mm (benchmarks.pokes --deep). Deeper steps cost more.
NODES = 5_500
SECONDS_TO_10_MM = 6.2
GROWTH = 1.6  # power of the requested depth that fits both
SECONDS_A_STEP = 0.6  # a hold, or a step of further travel
REACHED_MM = 23.0  # mean depth at which pokes end (recipe sample, 30 mm requested)
SURFACE_NODES = 1_700
_COMPRESSED = 0.57  # of the same dataset


@dataclass(frozen=True)
class Estimate:
    """Expected time and size of a build.

    Attributes
    ----------
    nodes : int
        Nodes per mesh.
    poke_seconds : float
        Time of one solve on one core [s].
    seconds : float
        Wall time of the missing pokes [s].
    size : float
        Size of the store [bytes].
    missing : int
        Number of pokes that are not done.
    solves : int
        Number of solves for these; pokes that differ only by a factor of the moduli share one.
    measured : bool
        True if `poke_seconds` comes from this build's ledger.
    """

    nodes: int
    poke_seconds: float
    seconds: float
    size: float
    missing: int
    solves: int
    measured: bool


def estimate(plan: Plan, target: Path, workers: int, *, overwrite: bool = False) -> Estimate:
    """Estimate time and size from the ledger of the run so far, or else roughly from measured defaults.

    DamagedError if the target is a damaged store that is not overwritten; InputError if what is there is of
    another plan.
    """
    staging = Staging(target)
    ledger = read_ledger(staging.ledger_file)
    walls = [float(entry["wall_seconds"]) for entry in ledger.values() if not entry.get("error")]
    asked = plan.recipe.protocol.depth_mm / 10.0
    each = fmean(walls) if walls else SECONDS_TO_10_MM * asked**GROWTH
    if not overwrite:
        check_continues(plan, target, staging)
    if overwrite:
        finished = set()
    elif is_built(plan, target, staging):
        finished = {poke.index for poke in plan.pokes}
    else:
        finished = staging.finished()
    missing = max(len(plan.pokes) - len(finished), 0)
    solves = sum(not poke.derived and poke.index not in finished for poke in plan.pokes)
    frames = min(plan.recipe.protocol.depth_mm, REACHED_MM) / plan.recipe.protocol.frame_spacing_mm
    course = plan.pokes[0].scene.course
    if course is not None:
        frames = len(course.frames or ())
        each = each if walls else each + _seconds_after_loading(plan)
    frame_bytes = 12 * (1024 + SURFACE_NODES) + 200
    return Estimate(
        nodes=NODES,
        poke_seconds=each,
        seconds=solves * each / min(workers, max(solves, 1)),
        size=len(plan.pokes) * (frames * frame_bytes * _COMPRESSED + 60e3),
        missing=missing,
        solves=solves,
        measured=bool(walls),
    )


def _seconds_after_loading(plan: Plan) -> float:
    """Core time of the steps that a course adds to the first loading, mean of the plan's pokes [s]."""
    each = []
    for poke in plan.pokes:
        scene = poke.scene
        assert scene.course is not None
        depths = np.array([0.0, *(stop.value for stop in scene.course.stops(shortest_time(scene.material)))])
        moves = np.abs(np.diff(depths))
        travelled = np.ceil(moves[moves > 0.0] / LARGEST_STEP).sum() - deepest(scene) / LARGEST_STEP
        each.append(SECONDS_A_STEP * (max(travelled, 0.0) + (moves == 0.0).sum()))
    return fmean(each)


def traces_of(data: Dataset) -> dict[int, Trace]:
    """Pokes of a store by index; only that of the deepest one has its grid, since no other is drawn."""
    found = {}
    for index in map(int, np.flatnonzero(data.table["done"])):
        frames = data.rows(index, "frame")
        force = np.linalg.norm(data.table["rod_force"][frames], axis=1)
        found[index] = Trace(depth=data.table["depth"][frames], force=force, grid=None)
    moved = [index for index, trace in found.items() if len(trace.depth)]
    if moved:
        deepest = max(moved, key=lambda i: (found[i].depth.max(), -i))
        row = data.rows(deepest, "frame").start + int(np.argmax(found[deepest].depth))
        found[deepest] = replace(found[deepest], grid=data.read("grid_displacement", row))
    return found


def preview_path(target: Path) -> Path:
    """Path of the preview beside a store: NAME.png for NAME.zarr, else with .png after the whole name."""
    return target.with_name(f"{target.name.removesuffix('.zarr')}.png")


def plan_table(plan: Plan, target: Path, expected: Estimate, workers: int) -> Table:
    """Table of the plan, as printed by --dry-run."""
    protocol = plan.recipe.protocol
    table = Table(title=f"Plan: recipe {plan.recipe.name}, {plan.model}", show_header=False)
    table.add_row("store", str(target))
    table.add_row("uuid", plan.uuid)
    table.add_row(
        "pokes",
        f"{len(plan.pokes)} = {len(plan.inclusions)} shapes x {len(plan.materials)} material levels x "
        f"{plan.recipe.pokes_each} ({protocol.shared_sites} shared contact points, {protocol.own_sites} own)",
    )
    blocks = [plan.recipe.block_of(shape) for shape in plan.recipe.shapes]
    table.add_row("block", f"{sides_text(blocks)} mm")
    shared = f", by {expected.solves} solves" if expected.solves < expected.missing else ""
    table.add_row("to do", f"{expected.missing}{shared}")
    table.add_row("depth", f"{protocol.depth_mm:g} mm, a frame each {protocol.frame_spacing_mm:g} mm")
    if protocol.course:
        table.add_row("course", _course_text(plan))
    table.add_row("nodes", f"about {expected.nodes} per poke (each has its own mesh)")
    source = "measured so far" if expected.measured else "typical of a 2-core machine"
    table.add_row(
        "expected time",
        f"about {duration(expected.seconds)} with {workers} workers "
        f"({expected.poke_seconds:.0f} s per poke, {source})",
    )
    table.add_row("expected size", f"about {size_text(expected.size)}, twice that while it is built")
    derived = derived_levels(plan)
    for name, material in zip(plan.recipe.levels, plan.materials, strict=True):
        values = ", ".join(f"{key} = {_show(value)}" for key, value in material.parameters.items())
        law = "" if material.law == plan.model else f"{material.law}: "
        if name in derived:
            values += " (from the card's small-strain moduli: it has no parameters of this law)"
        parts = "".join(
            f"; {part.pop('kind')}: {', '.join(f'{k} = {_show(v)}' for k, v in part.items())}"
            for part in part_entries(material).values()
        )
        table.add_row(f"material {name}", law + values + parts)
    for name, text in effect_lines(plan):
        table.add_row(f"effect in {name}", text)
    return table


def _course_text(plan: Plan) -> str:
    """Text of the rod's course: its pieces, its duration and its largest number of frames."""
    words = []
    for piece in plan.recipe.protocol.course:
        if isinstance(piece, HoldRecipe):
            words.append(f"hold {piece.hold_s:g} s")
            continue
        low, high = piece.speed_mm_per_s
        words.append(f"to {piece.to_mm:g} mm at {low:g}{'' if low == high else f' to {high:g}'} mm/s")
    courses = [poke.scene.course for poke in plan.pokes]
    lengths = [course.duration for course in courses if course is not None]
    frames = max(len(course.frames or ()) for course in courses if course is not None)
    long = " to ".join(f"{v:.3g}" for v in sorted({round(min(lengths), 6), round(max(lengths), 6)}))
    return f"{', '.join(words)}: {long} s, up to {frames} frames"


def effect_lines(plan: Plan) -> list[tuple[str, str]]:
    """Mixture and text of each effect of the cards; the text states whether the dataset applies it."""
    lines = []
    for card in plan.cards:
        for effect in card.effects:
            left = effect.left_out(card.material)
            if effect.is_law and plan.model != card.law:
                word = f"not taken over: the card's law {card.law} has it: give --model {card.law}"
            elif effect.becomes not in (None, "law") or effect.is_law:
                word = f"taken over as the card's {effect.becomes}"
            else:
                word = f"not taken over: {left}" if left else f"taken over {TAKEN[effect.effect][1]}"
            lines.append((card.material, f"{effect.describe()}: {word}"))
    return lines


def derived_levels(plan: Plan) -> list[str]:
    """Material levels whose card has no parameters of the plan's model."""
    return [card.material for card in plan.cards if not card.holds(plan.model)]


def _show(value: Any) -> str:
    if isinstance(value, str):
        return value
    return ", ".join(f"{v:g}" for v in value) if isinstance(value, tuple | list) else f"{value:g}"


class Screen:
    """Progress of one build: a bar on a terminal, otherwise a line every `_LINE_SECONDS`."""

    def __init__(self, plan: Plan, target: Path, console: Console, expected: Estimate) -> None:
        self._plan, self._target, self._console, self._expected = plan, target, console, expected
        self._traces: dict[int, Trace] = {}
        self._began = self._line = self._picture = time.monotonic()
        self._first, self._foreign = 0, False
        self._bar = Progress(
            TextColumn("pokes"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[failed]}"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[left]}"),
            console=console,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("pokes", total=len(plan.pokes), failed="", left="")

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def update(self, state: BuildProgress) -> None:
        """Callback `on_progress` of the build, called at the start and after each poke."""
        now = time.monotonic()
        if state.outcome is None:
            self._first = state.done
            for index in sorted(state.staging.finished()):
                self._add(index, state.staging.result_path(index).read_bytes())
            self._console.print(f"Building {self._target}: {state.done} of {state.total} pokes are done.")
        elif state.outcome.payload is not None:
            self._add(state.outcome.index, state.outcome.payload)
        fresh = state.done + state.failed - self._first
        each = (now - self._began) / fresh if fresh else None
        todo = state.total - state.done - state.failed
        remaining = todo * each if each is not None else self._expected.seconds
        left = f"about {duration(remaining)} left"
        self._bar.update(
            self._task,
            completed=state.done,
            failed=f"{state.failed} failed" if state.failed else "",
            left=left,
        )
        if not self._console.is_terminal and (now - self._line > _LINE_SECONDS or todo == 0):
            self._line = now
            failed = f", {state.failed} failed" if state.failed else ""
            self._console.print(f"{state.done} of {state.total} pokes done{failed}, {left}")
        # the preview beside a whole store is its own until it is replaced
        if now - self._picture > _PICTURE_SECONDS and not state.staging.overwriting.exists():
            self._draw()
            self._picture = time.monotonic()

    def finish(self, built: Built) -> None:
        """Draw the last preview, if that beside the store is not of it, and print a summary of the build."""
        from factory.inspection.figures import preview_of

        of = manifest_digest(self._target)
        if not self._traces and of and preview_of(preview_path(self._target)) != of:
            self._read_store()  # of a build that was killed when the store was in place
        if self._traces or not preview_path(self._target).exists():
            self._draw(of)
        new = f"{built.simulated} simulated now"
        if not built.simulated:
            new = "none simulated with success now" if built.errors else "nothing was left to simulate"
        if built.missing:
            new = "partial: the others are marked as not done; without --partial the same command goes on"
        if built.damaged:
            count = len(built.damaged)
            pokes = ", ".join(str(i) for i in built.damaged[:8]) + (" ..." if count > 8 else "")
            self._console.print(
                f"{count} staged {'results were' if count > 1 else 'result was'} damaged and set aside"
                f"{'' if built.missing else ', and simulated again'} (poke {pokes})."
            )
        done = built.total - (built.missing or len(built.errors))
        self._console.print(
            f"{self._target}: {done} of {built.total} pokes ({new}); "
            f"preview {preview_path(self._target).name}"
        )

    def _add(self, index: int, payload: bytes) -> None:
        with uninterrupted(), np.load(io.BytesIO(payload)) as part:
            depth = part["depth"]
            deepest = part["grid_displacement"][int(np.argmax(depth))] if len(depth) else None
            self._traces[index] = Trace(
                depth=depth,
                force=np.linalg.norm(part["rod_force"], axis=1),
                grid=deepest,
            )

    def _read_store(self) -> None:
        from factory.reader import open_dataset

        try:
            self._traces = traces_of(open_dataset(self._target))
        except InputError as error:  # a build must not fail for its preview
            log.warning("no preview picture: %s.", error)

    def _draw(self, of: str = "") -> None:
        from factory.inspection.figures import NotOursError, draw_preview

        try:
            draw_preview(self._plan, self._traces, preview_path(self._target), of)
        except NotOursError as error:
            if not self._foreign:  # once
                log.warning("%s.", error)
            self._foreign = True
        except OSError as error:  # a build must not fail for its preview
            log.warning("%s.", describe_os_error(error, "no preview picture:"))
