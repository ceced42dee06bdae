"""What is in a dataset, poke by poke, whether it is finished or still being built."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from factory._manifest import LEDGER
from factory._parts import Parts, building_folder, read_ledger
from factory._record import STATUSES
from factory.errors import InputError
from factory.reader import open_dataset

# the paper's table of dataset features: law -> softness -> mean and sd of Sim_max [mm], F_max [N],
# Tip_mean [mm], F_mean [N]
PAPER: dict[str, dict[str, tuple[tuple[float, float], ...]]] = {
    "mooney-rivlin": {
        "S0": ((13.92, 3.88), (12.92, 5.32), (7.91, 4.82), (4.80, 4.59)),
        "S0.5": ((13.78, 4.14), (6.19, 2.69), (7.94, 4.89), (2.33, 2.30)),
        "S1": ((13.46, 4.24), (3.87, 2.43), (7.82, 4.87), (1.42, 1.54)),
    },
    "ogden": {
        "S0": ((16.32, 6.53), (29.71, 25.31), (9.88, 6.54), (6.94, 11.44)),
        "S0.5": ((16.40, 6.41), (18.35, 18.67), (9.89, 6.54), (3.94, 7.47)),
        "S1": ((11.20, 4.82), (2.34, 1.98), (7.04, 4.87), (1.01, 1.19)),
    },
}


@dataclass(frozen=True, eq=False, kw_only=True)
class PokeSummary:
    """depth [m] and force [N]: of each frame."""

    index: int
    shape: str
    softness: str
    status: str
    message: str
    nodes: int
    depth: NDArray[np.float64]
    force: NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Summary:
    """finished: the store is complete on disk (failed pokes count as finished, with their error)."""

    path: Path
    finished: bool
    model: str
    recipe: str
    uuid: str
    pokes: int
    shapes: list[str]
    softness: list[str]
    done: list[PokeSummary]
    failed: dict[int, str]
    ledger: dict[int, dict[str, Any]]


def summarise(path: Path) -> Summary:
    """Summary of a store, or of the building folder where the store is not there yet."""
    building = building_folder(path)
    if not path.exists() and (building / "plan.json").is_file():
        return _of_parts(path, building)
    data = open_dataset(path)
    table, attributes = data.table, data.attributes
    force = np.linalg.norm(table["rod_force"], axis=1)
    done, failed = [], {}
    for i in range(data.n_pokes):
        if not table["done"][i]:
            failed[i] = data.message(i)
            continue
        frames = data.rows(i, "frame")
        done.append(
            PokeSummary(
                index=i,
                shape=attributes["shapes"][int(table["poke_shape"][i])],
                softness=attributes["softness"][int(table["poke_softness"][i])],
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
        shapes=attributes["shapes"],
        softness=attributes["softness"],
        done=done,
        failed=failed,
        ledger=read_ledger(path / LEDGER),
    )


def _of_parts(path: Path, building: Path) -> Summary:
    try:
        identity = json.loads((building / "plan.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise InputError(f"{building / 'plan.json'}: unreadable") from None
    recipe = identity["recipe"]
    shapes = [shape["id"] for shape in recipe["shapes"]]
    softness = list(recipe["softness"])
    each = recipe["protocol"]["shared_sites"] + recipe["protocol"]["own_sites"]
    parts = Parts(path)
    done = []
    for index in sorted(parts.done()):
        with parts.opened(index) as part:
            done.append(
                PokeSummary(
                    index=index,
                    shape=shapes[index // (each * len(softness))],
                    softness=softness[index // each % len(softness)],
                    status=str(STATUSES[int(part["status"])]),
                    message=part["message"].tobytes().decode(errors="replace"),
                    nodes=int(part["mesh_nodes"]),
                    depth=part["depth"],
                    force=np.linalg.norm(part["rod_force"], axis=1),
                )
            )
    return Summary(
        path=path,
        finished=False,
        model=identity["model"],
        recipe=recipe["name"],
        uuid="given on completion",
        pokes=each * len(softness) * len(shapes),
        shapes=shapes,
        softness=softness,
        done=done,
        failed=parts.errors(),
        ledger=read_ledger(parts.ledger_file),
    )
