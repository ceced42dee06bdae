"""Names of trials in a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol


class Named(Protocol):
    @property
    def name(self) -> str: ...


def listed(records: Sequence[Named]) -> str:
    """Names of records, a few of them where there are many."""
    names = [r.name for r in records]
    return ", ".join(names) if len(names) <= 6 else f"{', '.join(names[:5])} and {len(names) - 5} more"
