"""Building a dataset: plan, resume, simulate, assemble. Used by the command and by tests."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from factory._assemble import assemble
from factory._cluster import run_cluster
from factory._parts import Parts
from factory._pool import run_local
from factory._record import Outcome
from factory._store import root_attributes
from factory._worker import SIMULATOR
from factory.errors import InputError, describe_os_error
from factory.plan import Plan, PlannedPoke, changes


@dataclass(frozen=True)
class Progress:
    """How far a build is. outcome: the poke that just came in (None at the start)."""

    done: int
    failed: int
    total: int
    outcome: Outcome | None = None


@dataclass(frozen=True)
class Built:
    """How a build ended. fresh: pokes simulated by this run; errors: text by poke index."""

    store: Path
    total: int
    fresh: int
    errors: dict[int, str]


Watch = Callable[[Progress, Parts], None]


@dataclass(frozen=True, kw_only=True)
class Means:
    """What simulates: worker processes here or a dask cluster, and the function that they call."""

    workers: int = 2
    cluster: str | None = None
    simulator: str = SIMULATOR

    def run(self, pokes: list[PlannedPoke]) -> Generator[Outcome]:
        if self.cluster is None:
            return run_local(pokes, workers=self.workers, simulator=self.simulator)
        return run_cluster(pokes, address=self.cluster, workers=self.workers, simulator=self.simulator)


def build(
    plan: Plan,
    target: Path,
    *,
    overwrite: bool = False,
    workers: int = 2,
    cluster: str | None = None,
    simulator: str = SIMULATOR,
    watch: Watch | None = None,
) -> Built:
    """Builds or completes the dataset `target`; the same call goes on after any interruption.

    overwrite: simulate everything again; what is there stays until the new store is complete.
    cluster: a dask scheduler's address, or "local".
    InputError says in one sentence why nothing was done, or why the build stopped.
    """
    check_target(target)
    try:
        with Parts(target) as parts:
            if _already(plan, target, parts, overwrite):
                return Built(target, len(plan.pokes), 0, {})
            means = Means(workers=workers, cluster=cluster, simulator=simulator)
            fresh = _simulate(plan, parts, means, watch)
            errors = parts.errors()
            assemble(plan, parts, target)
            if not errors:
                parts.remove()
            return Built(target, len(plan.pokes), fresh, errors)
    except OSError as error:
        raise InputError(
            describe_os_error(error, f"{target}: the build stopped at")
            + "; every finished poke is kept, and the same command goes on from there"
        ) from error


def check_target(target: Path) -> None:
    """Refuses targets that are something else than a store of ours."""
    if target.exists() and root_attributes(target) is None:
        raise InputError(f"{target}: exists and is not a dataset of the factory: give another --out")


def _already(plan: Plan, target: Path, parts: Parts, overwrite: bool) -> bool:
    """Whether the target is complete; if not, the building folder is ready for this plan afterwards."""
    if overwrite:
        parts.begin(plan.identity)
        return False
    finished, begun = root_attributes(target), parts.read_plan()
    if begun is not None and begun != plan.identity:
        raise _changed(f"{parts.folder}: was begun", begun, plan)
    if finished is not None and finished["fingerprint"] == plan.fingerprint:
        if finished["pokes_done"] == finished["pokes"]:
            parts.remove()  # what a build killed while tidying up has left, or our lock
            return True
        if begun is None:
            parts.remove()
            raise InputError(
                f"{target}: has failed pokes, and {parts.folder.name} with the others is gone: "
                "give --overwrite to build it again"
            )
    elif finished is not None and begun is None:
        parts.remove()
        raise _changed(f"{target}: was built", finished["identity"], plan)
    if begun is None:
        parts.begin(plan.identity)
    parts.parts.mkdir(exist_ok=True)
    return False


def _simulate(plan: Plan, parts: Parts, means: Means, watch: Watch | None) -> int:
    """Simulates what is missing; returns how many pokes succeeded."""
    done = parts.done()
    missing = [poke for poke in plan.pokes if poke.index not in done]
    total, fresh, failed = len(plan.pokes), 0, 0
    if watch is not None:
        watch(Progress(len(done), 0, total), parts)
    if not missing:
        return 0
    with closing(means.run(missing)) as outcomes:
        for outcome in outcomes:
            parts.keep(outcome)
            parts.log(
                {
                    "poke": outcome.index,
                    "wall_seconds": round(outcome.wall, 3),
                    "core_seconds": round(outcome.core, 3),
                    "error": outcome.error,
                }
            )
            fresh += outcome.error is None
            failed += outcome.error is not None
            if watch is not None:
                watch(Progress(len(done) + fresh, failed, total, outcome), parts)
    return fresh


def _changed(state: str, old: dict[str, object], plan: Plan) -> InputError:
    return InputError(
        f"{state} with another plan (changed: {changes(old, plan.identity)}): "
        "give --overwrite to build it anew, or another --out"
    )
