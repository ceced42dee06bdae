"""Build a dataset: resume, simulate, assemble."""

from __future__ import annotations

import logging
import shlex
import shutil
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path

from factory.errors import InputError, describe_os_error
from factory.plan.dataset import Plan, changes
from factory.plan.poke import PlannedPoke
from factory.simulation.cluster import CLUSTER_TIMEOUT, run_cluster
from factory.simulation.execution import SIMULATOR
from factory.simulation.local import run_local
from factory.simulation.proportion import arrays_of, in_proportion
from factory.simulation.record import Outcome
from factory.store.assemble import assemble
from factory.store.files import DamagedError, is_store, root_attributes
from factory.store.staging import DamagedResultError, Staging, set_damaged_aside

log = logging.getLogger(__name__)
_ROUNDS = 3  # attempts to write the store; results found damaged are simulated again in between


@dataclass(frozen=True)
class BuildProgress:
    """State of a build, passed to `on_progress` at the start and after each poke.

    Attributes
    ----------
    done, failed, total : int
        Pokes with a staged result, pokes that failed in this run, pokes of the plan.
    staging : Staging
        The folder of the staged results.
    outcome : Outcome or None
        The poke that was just staged; None at the start.
    """

    done: int
    failed: int
    total: int
    staging: Staging
    outcome: Outcome | None = None


@dataclass(frozen=True)
class Built:
    """Result of a build.

    Attributes
    ----------
    store : Path
        The dataset.
    total : int
        Pokes of the plan.
    simulated : int
        Number of pokes that succeeded in this run.
    errors : dict of int to str
        Error texts of failed pokes, by index.
    damaged : tuple of int
        Pokes whose staged result was damaged: simulated again, or, in a partial store, set aside.
    missing : int
        Number of pokes of a partial store that are not done.
    """

    store: Path
    total: int
    simulated: int
    errors: dict[int, str] = field(default_factory=dict)
    damaged: tuple[int, ...] = ()
    missing: int = 0


OnProgress = Callable[[BuildProgress], None]


@dataclass(frozen=True, kw_only=True)
class _Means:
    """Local worker processes or a dask cluster, and the simulator that they call."""

    workers: int
    cluster: str | None
    cluster_timeout: float
    simulator: str

    def run(self, pokes: list[PlannedPoke]) -> Generator[Outcome]:
        if self.cluster is None:
            return run_local(pokes, workers=self.workers, simulator=self.simulator)
        return run_cluster(
            pokes,
            address=self.cluster,
            workers=self.workers,
            simulator=self.simulator,
            timeout=self.cluster_timeout,
        )


def build_dataset(
    plan: Plan,
    target: Path,
    *,
    overwrite: bool = False,
    partial: bool = False,
    workers: int = 2,
    cluster: str | None = None,
    cluster_timeout: float = CLUSTER_TIMEOUT,
    simulator: str = SIMULATOR,
    on_progress: OnProgress | None = None,
) -> Built:
    """Build or complete a dataset; after any interruption the same call resumes and gives the same bytes.

    Parameters
    ----------
    plan : Plan
    target : Path
        The store to write; it is built in the folder TARGET.building beside it.
    overwrite : bool
        Simulate everything again; an old store stays until the new one is complete.
    partial : bool
        Simulate nothing: write a store of the pokes that earlier runs finished, with the others marked as not
        done. Staged results are kept, so that a later call can resume.
    workers : int
        Worker processes on this machine.
    cluster : str, optional
        Address of a dask scheduler, or "local".
    cluster_timeout : float
        Time [s] without a scheduler or without a worker after which the build gives up.
    simulator : str
        "module:function" to call in place of `tisim.simulate`.
    on_progress : callable, optional
        Called with a `BuildProgress` at the start and after each poke.

    Returns
    -------
    Built
        Pokes that failed are in its `errors`; the store marks them as not done.

    Raises
    ------
    InputError
        If nothing was done or the build stopped; one sentence states why. Every finished poke is kept.
    """
    check_target(target, overwrite=overwrite)
    try:
        with Staging(target) as staging:
            if _is_complete(plan, target, staging, overwrite):
                return Built(target, len(plan.pokes), 0)
            if partial:
                return _written_so_far(plan, target, staging, on_progress)
            means = _Means(
                workers=workers, cluster=cluster, cluster_timeout=cluster_timeout, simulator=simulator
            )
            damaged = set_damaged_aside(staging, plan.pokes)
            simulated = _simulate(plan, staging, means, on_progress)
            for left in reversed(range(_ROUNDS)):
                try:
                    _keep_complete(target, plan, staging)
                    assemble(plan, staging, target)
                    staging.overwriting.unlink(missing_ok=True)
                    break
                except DamagedResultError as error:
                    if not left:
                        raise InputError(
                            f"{staging.results}: {error}, {_ROUNDS} times in a row; is the disk sound?"
                        ) from None
                    staging.set_aside(error.index, error.reason)
                    damaged.append(error.index)
                    simulated += _simulate(plan, staging, means, on_progress)
            errors = staging.errors()
            if not errors:
                staging.remove()
            return Built(target, len(plan.pokes), simulated, errors, tuple(sorted(set(damaged))))
    except OSError as error:
        raise InputError(
            describe_os_error(error, f"{target}: the build stopped at")
            + "; every finished poke is kept, and the same command goes on from there"
        ) from error


def _written_so_far(plan: Plan, target: Path, staging: Staging, on_progress: OnProgress | None) -> Built:
    """Write a store of the staged results; InputError if there are none."""
    damaged = set_damaged_aside(staging, plan.pokes)
    _derive(plan, staging, staging.stage)
    done = len(staging.finished())
    missing = len(plan.pokes) - done
    if on_progress is not None and done:
        on_progress(BuildProgress(done, 0, len(plan.pokes), staging))
    if missing == len(plan.pokes):
        staging.remove()
        raise InputError(f"{target}: --partial: no poke of it is finished yet: begin it without --partial")
    if missing and _is_whole(target):
        raise InputError(
            f"{target}: --partial: holds a complete dataset, which a part of another would replace: give"
            " another --out"
        )
    assemble(plan, staging, target)
    if not missing and not staging.errors():
        staging.remove()
    return Built(target, len(plan.pokes), 0, staging.errors(), tuple(damaged), missing)


def _is_whole(target: Path) -> bool:
    """True if the target is a dataset with all its pokes."""
    try:
        found = root_attributes(target)
    except DamagedError:
        return False
    return found is not None and bool(found["pokes_done"] == found["pokes"])


def _keep_complete(target: Path, plan: Plan, staging: Staging) -> None:
    """Raise InputError if a store with failed pokes would replace a complete one."""
    errors = staging.errors()
    if errors and _is_whole(target):
        index, said = next(iter(errors.items()))
        raise InputError(
            f"{target}: {len(errors)} of {len(plan.pokes)} pokes failed (first: poke {index}: {said}); the"
            " complete dataset that is there stays. The same command without --overwrite tries them again"
        )


def check_target(target: Path, *, overwrite: bool = False) -> None:
    """Refuse a target that is not a dataset, or is a damaged one and `overwrite` is False."""
    if not target.exists():
        return
    if not is_store(target):
        raise InputError(f"{target}: exists and is not a dataset of the factory: give another --out")
    try:
        root_attributes(target)
    except DamagedError as error:
        if not overwrite:
            raise InputError(
                f"{error}: the dataset is damaged: give --overwrite to build it anew, or another --out"
            ) from None


def free_name(target: Path) -> Path:
    """First unused path beside the target: NAME-2.zarr, NAME-3.zarr ..."""
    number = 2
    suffix = ".zarr" if target.suffix == ".zarr" else ""
    while (found := target.with_name(f"{target.name.removesuffix(suffix)}-{number}{suffix}")).exists():
        number += 1
    return found


def warn_of_full_disk(target: Path, needed: float) -> bool:
    """Log a warning, and return True, if the disk has less free space than `needed` [bytes]."""
    folder = next(path for path in (target, *target.parents) if path.exists())
    free = shutil.disk_usage(folder).free
    if free >= needed:
        return False
    log.warning(
        "%s: %.1f GB are free, and the build is expected to need %.1f GB: it may stop on a full disk, and "
        "goes on from there when there is room.",
        folder,
        free / 1e9,
        needed / 1e9,
    )
    return True


def is_built(plan: Plan, target: Path, staging: Staging) -> bool:
    """True if the target has all pokes of this plan, and no stopped build is to replace it."""
    finished = root_attributes(target)
    if finished is None or finished["fingerprint"] != plan.fingerprint:
        return False
    replaces = staging.read_plan() is not None and staging.overwriting.exists()
    return bool(finished["pokes_done"] == finished["pokes"]) and not replaces


def check_continues(plan: Plan, target: Path, staging: Staging) -> None:
    """Refuse to continue what another plan began or built; changes nothing."""
    finished, begun = root_attributes(target), staging.read_plan()
    if begun is not None and begun != plan.identity:
        raise _changed(f"{staging.folder}: was begun", begun, plan, target)
    if finished is None or begun is not None or is_built(plan, target, staging):
        return
    if finished["fingerprint"] != plan.fingerprint:
        raise _changed(f"{target}: was built", finished["identity"], plan, target)
    raise InputError(
        f"{target}: has failed pokes, and {staging.folder.name} with the others is gone: "
        "give --overwrite to build it again"
    )


def _is_complete(plan: Plan, target: Path, staging: Staging, overwrite: bool) -> bool:
    """True if the target is complete; if not, prepare the building folder for this plan."""
    if overwrite:
        staging.begin(plan.identity, overwrites=target.exists())
        return False
    begun = staging.read_plan()
    try:
        check_continues(plan, target, staging)
    except InputError:
        if begun is None:
            staging.remove()
        raise
    if is_built(plan, target, staging):
        staging.remove()  # remains of a build killed during its clean-up, or our lock
        return True
    if begun is None:
        staging.begin(plan.identity)
    staging.results.mkdir(exist_ok=True)
    return False


def _simulate(plan: Plan, staging: Staging, means: _Means, on_progress: OnProgress | None) -> int:
    """Simulate the missing pokes; return the number that succeeded."""
    done = staging.finished()
    missing = [poke for poke in plan.pokes if poke.index not in done]
    total, simulated, failed = len(plan.pokes), 0, 0
    if on_progress is not None:
        on_progress(BuildProgress(len(done), 0, total, staging))
    if not missing:
        return 0
    derived: dict[int, list[PlannedPoke]] = {}
    for poke in missing:
        if poke.derived:
            derived.setdefault(poke.solved_as, []).append(poke)

    def keep(outcome: Outcome) -> None:
        nonlocal simulated, failed
        staging.stage(outcome)
        simulated += outcome.error is None
        failed += outcome.error is not None
        if outcome.error is not None:
            log.debug("poke %d failed: %s", outcome.index, outcome.error)
        if on_progress is not None:
            on_progress(BuildProgress(len(done) + simulated, failed, total, staging, outcome))

    _derive(plan, staging, keep)
    own = [poke for poke in in_turns(plan) if poke.index not in done and not poke.derived]
    if not own:
        return simulated
    with closing(means.run(own)) as outcomes:
        for outcome in outcomes:
            keep(outcome)
            staging.note_times(outcome)
            if outcome.index not in derived:
                continue
            for poke in derived[outcome.index]:
                if outcome.error is None:
                    keep(in_proportion(arrays_of(outcome), poke))
                else:
                    keep(replace(outcome, index=poke.index, wall=0.0, core=0.0))
    return simulated


def _derive(plan: Plan, staging: Staging, keep: Callable[[Outcome], None]) -> None:
    """Pass to `keep` the missing pokes whose solve is staged: a kill can come between it and them."""
    done = staging.finished()
    for poke in plan.pokes:
        if poke.derived and poke.index not in done and poke.solved_as in done:
            with staging.opened(poke.solved_as) as arrays:
                keep(in_proportion(dict(arrays), poke))


def in_turns(plan: Plan) -> list[PlannedPoke]:
    """Pokes in the order of simulation: one of each shape and material level at a time.

    After an interruption the results are then a smaller dataset of all shapes, not of the first ones alone.
    """
    shared = plan.recipe.protocol.shared_sites
    return sorted(plan.pokes, key=lambda poke: (poke.site if poke.shared else poke.site - shared, poke.index))


def _changed(state: str, old: dict[str, object], plan: Plan, target: Path) -> InputError:
    return InputError(
        f"{state} with another plan (changed: {changes(old, plan.identity)}): give another --out, "
        f"--out {shlex.quote(str(free_name(target)))} for example, or --overwrite to build it anew"
    )
