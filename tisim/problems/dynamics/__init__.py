"""Beams through time: BDF2 and central differences."""
