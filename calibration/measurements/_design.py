"""Experiments that a lab can do next: other tests of the same specimens, and direct measurements."""

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

    Attributes
    ----------
    name : name of the test.
    sentence : instruction for the lab.
    trials : function from a specimen's records to its new trials; empty if the test cannot be done.
    """

    name: str
    sentence: str
    trials: Callable[[Sequence[RecordT]], Sequence[TrialT]]

    def of_each(self, records: Sequence[RecordT]) -> list[TrialT]:
        """New trials of all specimens of these records."""
        specimens = dict.fromkeys(r.specimen for r in records)
        return [t for s in specimens for t in self.trials([r for r in records if r.specimen == s])]


@dataclass(frozen=True, kw_only=True)
class Gauge:
    """A direct measurement of effects.

    Attributes
    ----------
    name : name of the measurement.
    sentence : instruction for the lab.
    sds : standard deviation of the measured amplitude [SI], by effect.
    """

    name: str
    sentence: str
    sds: Mapping[str, float] = field(default_factory=dict)
