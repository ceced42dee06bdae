"""Calibration: photographs and records in, material cards out. SI units; millimetres only in files."""
