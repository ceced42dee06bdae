"""Errors that people can act on: one sentence, no traceback."""

from __future__ import annotations


class InputError(Exception):
    """Bad input or an unusable target; its text is one sentence for people (exit code 2)."""


class OutsideDomainError(InputError):
    """A poke that is not within what the model was trained on, where only such pokes are asked for."""
