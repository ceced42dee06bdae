"""One thread per scene: BLAS threads that spin while they wait slow a solver down by a factor of two."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

_depth = 0


@contextmanager
def one_thread() -> Iterator[None]:
    """Context in which BLAS uses one thread; entering takes 1 ms, or no time inside another such context."""
    global _depth
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
