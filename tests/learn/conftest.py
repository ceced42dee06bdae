"""Fixtures for all tests of learn."""

from tests.unrendered import unrendered

__all__ = ["unrendered"]
