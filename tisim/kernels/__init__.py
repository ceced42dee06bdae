"""Taichi kernels behind plain NumPy interfaces; nothing here knows what a scene is."""
