"""Summary of a dataset, poke by poke, also while it is being built."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from factory.errors import InputError, describe_os_error
from factory.reader import name_of, open_dataset
from factory.simulation.record import STATUSES
from factory.store.files import LEDGER, check_identity, read_json, read_ledger
from factory.store.staging import DamagedResultError, Staging, building_folder


@dataclass(frozen=True, eq=False, kw_only=True)
class PokeSummary:
    """One poke.

    Attributes
    ----------
    index : int
    shape, level, status, message : str
    nodes : int
        Nodes of the volume mesh.
    depth, force : ndarray, shape (frames,)
        Travel of the indenter [m] and magnitude of the force on it [N].
    """

    index: int
    shape: str
    level: str
    status: str
    message: str
    nodes: int
    depth: NDArray[np.float64]
    force: NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Summary:
    """A dataset.

    Attributes
    ----------
    path : Path
    finished : bool
        True if there is a store (possibly partial), False if only staged results.
    model, recipe, uuid : str
    pokes : int
        Number of pokes in the plan.
    shapes, levels : list of str
    done : list of PokeSummary
    failed, damaged : dict of int to str
        Error texts of failed pokes, and of damaged staged results, by index.
    ledger : dict of int to dict
        Wall times by index.
    waiting : int
        Number of pokes that a partial store lacks.
    replacement : str
        Sentence on a build that is to replace the store and is not complete; empty without one.
    """

    path: Path
    finished: bool
    model: str
    recipe: str
    uuid: str
    pokes: int
    shapes: list[str]
    levels: list[str]
    done: list[PokeSummary]
    failed: dict[int, str]
    ledger: dict[int, dict[str, Any]]
    damaged: dict[int, str] = field(default_factory=dict)
    waiting: int = 0
    replacement: str = ""


def summarise(path: str | Path) -> Summary:
    """Summarise a dataset, or its building folder if there is no store yet.

    Raises
    ------
    InputError
        If there is neither, or its files are damaged.
    """
    path = Path(path)
    building = building_folder(path)
    if not path.exists() and (building / "plan.json").is_file():
        return _of_staging(path)
    data = open_dataset(path)
    data.check_rows()
    data.check_sums()
    table, attributes = data.table, data.attributes
    force = np.linalg.norm(table["rod_force"], axis=1)
    done, failed = [], {}
    waiting = set(data.waiting)
    for i in range(data.n_pokes):
        if i in waiting:
            continue
        if not table["done"][i]:
            failed[i] = data.message(i)
            continue
        frames = data.rows(i, "frame")
        done.append(
            PokeSummary(
                index=i,
                shape=name_of(data.shapes, int(table["poke_shape"][i])),
                level=name_of(data.levels, int(table["poke_softness"][i])),
                status=data.status(i),
                message=data.message(i),
                nodes=int(table["mesh_nodes"][i]),
                depth=table["depth"][frames],
                force=force[frames],
            )
        )
    return Summary(
        path=path,
        finished=True,
        model=attributes["model"],
        recipe=attributes["identity"]["recipe"]["name"],
        uuid=attributes["uuid"],
        pokes=data.n_pokes,
        shapes=data.shapes,
        levels=data.levels,
        done=done,
        failed=failed,
        waiting=len(waiting),
        ledger=read_ledger(data.root / LEDGER),
        replacement=_replacement(Staging(path)),
    )


def _replacement(staging: Staging) -> str:
    """Sentence on a build that is to replace a finished store; empty if none was begun."""
    if not staging.overwriting.exists():
        return ""
    text = f"{staging.folder.name}: a build that replaces this dataset when it is complete has been begun"
    try:
        begun = staging.read_plan()
        if begun is None:
            return ""
        identity = check_identity(begun, staging.plan_file)
    except InputError as error:  # no fault of the dataset that is there
        return f"{text}, but {error}"
    return (
        f"{text}: recipe {identity['recipe']['name']}, {identity['model']}, {len(staging.finished())} of"
        f" {_planned(identity['recipe'])} pokes so far"
    )


def _planned(recipe: dict[str, Any]) -> int:
    """Number of pokes of a plan."""
    each = recipe["protocol"]["shared_sites"] + recipe["protocol"]["own_sites"]
    return int(each * len(recipe["softness"]) * len(recipe["shapes"]))


def _of_staging(path: Path) -> Summary:
    staging = Staging(path)
    try:
        identity = check_identity(read_json(staging.plan_file), staging.plan_file)
    except OSError as error:
        raise InputError(describe_os_error(error, "cannot read")) from None
    except ValueError:
        raise InputError(f"{staging.plan_file}: is damaged: it is not valid JSON") from None
    recipe = identity["recipe"]
    shapes = [shape["id"] for shape in recipe["shapes"]]
    levels = list(recipe["softness"])
    each = recipe["protocol"]["shared_sites"] + recipe["protocol"]["own_sites"]
    total = _planned(recipe)
    done, damaged = [], {}
    for index in sorted(staging.finished()):
        try:
            if index >= total:
                raise DamagedResultError(index, f"the plan has {total} pokes")
            with staging.opened(index) as result:
                done.append(
                    PokeSummary(
                        index=index,
                        shape=shapes[index // (each * len(levels))],
                        level=levels[index // each % len(levels)],
                        status=name_of([str(s) for s in STATUSES], int(result["status"])),
                        message=result["message"].tobytes().decode(errors="replace"),
                        nodes=int(result["mesh_nodes"]),
                        depth=result["depth"],
                        force=np.linalg.norm(result["rod_force"].reshape(-1, 3), axis=1),
                    )
                )
        except DamagedResultError as error:
            damaged[index] = error.reason
        except (TypeError, ValueError) as error:
            damaged[index] = str(error)
    return Summary(
        path=path,
        finished=False,
        model=identity["model"],
        recipe=recipe["name"],
        uuid="given on completion",
        pokes=total,
        shapes=shapes,
        levels=levels,
        done=done,
        failed=staging.errors(),
        ledger=read_ledger(staging.ledger_file),
        damaged=damaged,
    )
