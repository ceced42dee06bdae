"""Taichi kernels with NumPy interfaces, independent of scenes."""
