"""Uniaxial compression of a cylinder between two platens."""
