"""What a lab can do next: other tests of the same specimens, and direct measurements."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar


class OfSpecimen(Protocol):
    @property
    def specimen(self) -> str: ...


RecordT = TypeVar("RecordT", bound=OfSpecimen)
TrialT = TypeVar("TrialT")


@dataclass(frozen=True, kw_only=True)
class Test(Generic[RecordT, TrialT]):
    """Another test of each specimen.

    sentence: what to do. trials: the new ones of a specimen, of its records; none where it cannot be done.
    """

    name: str
    sentence: str
    trials: Callable[[Sequence[RecordT]], Sequence[TrialT]]

    def of_each(self, records: Sequence[RecordT]) -> list[TrialT]:
        """The new trials of all specimens that these records are of."""
        specimens = dict.fromkeys(r.specimen for r in records)
        return [t for s in specimens for t in self.trials([r for r in records if r.specimen == s])]


@dataclass(frozen=True, kw_only=True)
class Gauge:
    """A direct measurement: standard deviation [SI] with which it tells an effect's amplitude, by effect."""

    name: str
    sentence: str
    sds: Mapping[str, float] = field(default_factory=dict)
