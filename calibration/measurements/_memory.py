"""A cache of results by key, with batched evaluation."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Generic, TypeVar

KeyT = TypeVar("KeyT", bound=Hashable)
AnswerT = TypeVar("AnswerT")


class Memory(Generic[KeyT, AnswerT]):
    """Cache of results by key (first in, first out).

    Parameters
    ----------
    size : largest number of results; the oldest are dropped.
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._known: dict[KeyT, AnswerT] = {}

    def fetch(
        self, keys: Sequence[KeyT], answer: Callable[[Sequence[int]], Sequence[AnswerT]]
    ) -> list[AnswerT]:
        """Results of these keys, in their order.

        Parameters
        ----------
        answer : function from indices into `keys` to the results of these keys; it is called once, with the
            missing keys without duplicates, or not at all if none is missing.
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
