"""Errors that users can correct: one sentence, no traceback."""

from __future__ import annotations


class InputError(Exception):
    """Bad input or an unusable target; its text is one sentence for the user (exit code 2)."""


class OutsideDomainError(InputError):
    """A poke outside the domain of validity, when only pokes inside it are requested."""
