"""Cantilever release (free-vibration) tests, recorded by markers, with a hidden cause."""

from benchmarks.blind.release.cases import write_bars
from benchmarks.blind.release.model import DENSITY, GRAVITY, HEIGHT, LENGTH, WIDTH, Truth, beam

__all__ = ["DENSITY", "GRAVITY", "HEIGHT", "LENGTH", "WIDTH", "Truth", "beam", "write_bars"]
