"""Run one poke as one task in any process, and prepare such processes."""

from __future__ import annotations

import importlib
import importlib.metadata
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from factory.errors import InputError
from factory.plan.dataset import versions
from factory.plan.poke import PlannedPoke
from factory.simulation.record import Outcome, encode, record
from tisim.parallel.extensions import Extension, adopt, needed

SIMULATOR = "tisim:simulate"
ERROR_LENGTH = 400

Simulate = Callable[..., Sequence[Any]]


def sendable(pokes: Sequence[PlannedPoke]) -> tuple[Extension, ...]:
    """Laws registered from outside that the pokes need, to be sent to other processes; InputError if not."""
    found = needed([poke.scene for poke in pokes])
    if found is None:
        names = ", ".join(sorted({poke.scene.material.law for poke in pokes}))
        raise InputError(
            f"--model {names}: the law cannot be sent to worker processes: put it into a module of its own "
            "and give that with --plugin"
        )
    return found


def worker_facts() -> dict[str, str]:
    """Versions of what the bytes of a result depend on, in this process."""
    from tisim.linear.direct import HAVE_PARDISO

    return {
        **versions(),
        "scipy": importlib.metadata.version("scipy"),
        "taichi": importlib.metadata.version("taichi"),
        "solver": "PARDISO" if HAVE_PARDISO else "SuperLU",
    }


def load_simulator(name: str) -> Simulate:
    """The function behind "module:function"."""
    module, _, function = name.partition(":")
    found: Simulate = getattr(importlib.import_module(module), function)
    return found


def run_poke(poke: PlannedPoke, simulator: str = SIMULATOR, extensions: Sequence[Extension] = ()) -> Outcome:
    """Simulate one poke; any error is returned as text, so that the build continues.

    Parameters
    ----------
    poke : PlannedPoke
    simulator : str
        "module:function" with the signature of `tisim.simulate`.
    extensions : sequence of Extension
        Laws that were registered in the builder's process and that this one may lack.
    """
    wall, core = time.perf_counter(), time.process_time()
    payload: bytes | None = None
    error: str | None = None
    try:
        adopt(extensions)
        result = load_simulator(simulator)([poke.scene], workers=1)[0]
        arrays = record(poke.scene, result)
        arrays["poke"] = np.array(
            poke.index, dtype=np.int64
        )  # so that a file under another poke's name is recognised
        payload = encode(arrays)
    except Exception as problem:
        text = " ".join(str(problem).split())
        error = f"{type(problem).__name__}: {text}"[:ERROR_LENGTH]
    return Outcome(
        index=poke.index,
        payload=payload,
        error=error,
        wall=time.perf_counter() - wall,
        core=time.process_time() - core,
    )
