"""One poke, one task: what runs inside a worker process, local or of a cluster."""

from __future__ import annotations

import importlib
import os
import time
from collections.abc import Callable, Sequence
from typing import Any

from factory._record import Outcome, encode, record
from factory.plan import PlannedPoke

SIMULATOR = "tisim:simulate"
ERROR_LENGTH = 400

# one poke takes one core; more threads would only fight, and would change the order of sums
THREAD_VARIABLES = {
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    # MKL may otherwise pick another path for another memory alignment, and the bytes would differ
    "MKL_CBWR": "AUTO,STRICT",
}

Simulate = Callable[..., Sequence[Any]]


def load_simulator(name: str) -> Simulate:
    """The function behind "module:function"."""
    module, _, function = name.partition(":")
    found: Simulate = getattr(importlib.import_module(module), function)
    return found


def run_poke(poke: PlannedPoke, simulator: str = SIMULATOR) -> Outcome:
    """Simulates one poke; whatever goes wrong comes back as text, so that the build goes on."""
    wall, core = time.perf_counter(), time.process_time()
    payload: bytes | None = None
    error: str | None = None
    try:
        result = load_simulator(simulator)([poke.scene], workers=1)[0]
        payload = encode(record(poke.scene, result))
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


def end_with_parent(parent: int) -> None:
    """Ends this process soon after its parent is gone (kill -9 leaves no time to say goodbye)."""
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)
