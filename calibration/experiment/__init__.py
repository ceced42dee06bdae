"""Measured experiments: `read(folder)` checks everything that FORMAT.md asks for and returns SI dataclasses."""
