"""Checks of a finished store: bytes, shapes, physics, tissue left, and equilibrium by an assembly apart."""
