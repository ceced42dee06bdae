"""Homogeneous material tests."""
