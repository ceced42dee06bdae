"""One thread a scene: BLAS threads that spin while they wait cost a solver a factor of two."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

_depth = 0


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold BLAS to one thread within (1 ms); free where a caller holds it already."""
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
