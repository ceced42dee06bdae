"""Result of the test for lack of fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, eq=False, kw_only=True)
class LackOfFit:
    """Result of the lack-of-fit test.

    Attributes
    ----------
    p_value : p-value of all tests together.
    each : p-value of each test by its name.
    worst : name of the test with the smallest p-value.
    """

    p_value: float
    each: Mapping[str, float]
    worst: str
