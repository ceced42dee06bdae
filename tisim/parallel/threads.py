"""One thread per scene: BLAS threads that spin while they wait slow a solver down by a factor of two."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

# Environment of processes before they import anything: one core per scene. Further threads would compete,
# and would change the order of sums.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
# MKL may otherwise pick another path for another memory alignment, and the bytes would differ
SAME_BYTES = {**ONE_THREAD, "MKL_CBWR": "AUTO,STRICT"}

_depth = 0
_solving = threading.RLock()


@contextmanager
def one_thread() -> Iterator[None]:
    """Context in which BLAS uses one thread, and no other thread of this process solves.

    Scenes on one mesh share the factors and the work arrays of its discretisation, and the limit on BLAS is
    that of the process: another thread waits until the context is left. Entering takes 1 ms, or no time
    inside another such context.
    """
    global _depth
    with _solving:
        if _depth:
            yield
            return
        import scipy.linalg  # noqa: F401 - loads scipy's BLAS, so that its threads can be limited
        from threadpoolctl import threadpool_limits

        with threadpool_limits(1):
            _depth += 1
            try:
                yield
            finally:
                _depth -= 1
