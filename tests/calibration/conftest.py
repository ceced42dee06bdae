"""Lets these tests import what the tests of calibration share (`tests/calibration/_folders.py`)."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
