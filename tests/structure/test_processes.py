"""Tests share the cores by pytest-xdist; what they start takes none by itself."""

from __future__ import annotations

import os

from tisim.parallel import pool


def test_what_says_nothing_of_processes_starts_none() -> None:
    """The setting of `tests/conftest.py`, which anybody may set otherwise."""
    assert pool.cores() == min(int(os.environ["LOKY_MAX_CPU_COUNT"]), os.cpu_count() or 1)
