"""Answers that are remembered by what they depend on."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Generic, TypeVar

KeyT = TypeVar("KeyT", bound=Hashable)
AnswerT = TypeVar("AnswerT")


class Memory(Generic[KeyT, AnswerT]):
    """The last answers by their keys.

    Parameters
    ----------
    size : how many are kept; the oldest are forgotten.
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._known: dict[KeyT, AnswerT] = {}

    def fetch(
        self, keys: Sequence[KeyT], answer: Callable[[Sequence[int]], Sequence[AnswerT]]
    ) -> list[AnswerT]:
        """Answers of these keys, in their order.

        Parameters
        ----------
        answer : of those that are not known, by their index among the keys; a key that occurs twice is asked
            for once, and nothing is asked for where all are known.
        """
        first: dict[KeyT, int] = {}
        for k, key in enumerate(keys):
            if key not in self._known:
                first.setdefault(key, k)
        new = dict(zip(first, answer([*first.values()]), strict=True)) if first else {}
        found = [new[key] if key in new else self._known[key] for key in keys]
        self._known.update(new)
        while len(self._known) > self._size:
            self._known.pop(next(iter(self._known)))
        return found
