"""Errors that users can correct: one sentence, no traceback."""

from __future__ import annotations

from typing import Literal

Reason = Literal["site", "depth", "angle", "inclusion"]


class InputError(Exception):
    """Bad input or an unusable target; its text is one sentence for the user (exit code 2)."""


class OutsideDomainError(InputError):
    """A poke outside the domain of validity, when only pokes inside it are requested."""


class ImpossiblePokeError(InputError):
    """A pose that no poke of this block can have, although each of its values is one by itself.

    Attributes
    ----------
    reason : what is impossible: "site", the indenter touches beside the block; "depth", it is as deep as the
        block is high; "angle", it is inclined by more than 45 degrees; "inclusion", its tip has come to what
        is rigid.
    """

    def __init__(self, text: str, reason: Reason) -> None:
        super().__init__(text, reason)
        self.reason = reason

    def __str__(self) -> str:
        return str(self.args[0])
