"""Tests share the cores through pytest-xdist; the code under test starts no processes by itself."""

from __future__ import annotations

import os

from tisim.parallel import pool


def test_what_says_nothing_of_processes_starts_none() -> None:
    """`tests/conftest.py` sets LOKY_MAX_CPU_COUNT to 1, unless the environment has another value."""
    assert pool.cores() == min(int(os.environ["LOKY_MAX_CPU_COUNT"]), os.cpu_count() or 1)
