"""A Python process beside the tests', which can import modules of a folder."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import tisim


def python(folder: Path, *arguments: str) -> str:
    """Standard output of a process with this folder on its path; its errors, if it fails, fail the test."""
    path = os.pathsep.join([str(Path(tisim.__file__).parents[1]), str(folder)])
    done = subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()
