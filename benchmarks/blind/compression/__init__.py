"""Compression tests of cylinders between platens, with a hidden cause."""

from benchmarks.blind.compression.cases import KINDS, SHEAR_MODULI, Record, draw, write

__all__ = ["KINDS", "SHEAR_MODULI", "Record", "draw", "write"]
