"""Measured experiments (`measured/FORMAT.md`): read, checked, in SI."""
