"""Simulation of planned pokes: in processes here or on a cluster, and their results as arrays."""
