"""Checks of a scene's fields; each raises a FieldError that names the field and the expected value."""

from __future__ import annotations

from collections.abc import Callable
from numbers import Real
from typing import Any

import numpy as np

LARGEST = 10.0  # largest length [m]: larger ones are probably millimetres


class FieldError(ValueError):
    """A field of a scene has an invalid value.

    Attributes
    ----------
    field : str
        Dotted name of the field.
    """

    def __init__(self, field: str, expected: str, got: object) -> None:
        super().__init__(f"{field}: expected {expected}, got {got!r}")
        self.field, self._expected, self._got = field, expected, got

    def __reduce__(self) -> tuple[Any, ...]:
        return FieldError, (self.field, self._expected, self._got)

    def within(self, parent: str) -> FieldError:
        """The same error for the field `parent`.`field`."""
        return FieldError(f"{parent}.{self.field}", self._expected, self._got)


def check_number(field: str, value: object, expected: str, good: Callable[[float], bool]) -> None:
    number = isinstance(value, Real) and not isinstance(value, bool)
    if not number or not np.isfinite(float(value)) or not good(float(value)):  # type: ignore[arg-type]
        raise FieldError(field, expected, value)


def check_within(field: str, value: object, limit: float, unit: str) -> None:
    expected = f"a number between -{limit:.4g} and {limit:.4g}{unit}"
    check_number(field, value, expected, lambda v: abs(v) <= limit)


def check_length(field: str, value: object) -> None:
    check_number(field, value, f"a length above 0 and up to {LARGEST:g} m", lambda v: 0.0 < v <= LARGEST)


def check_positive(field: str, value: object, what: str = "a number above 0") -> None:
    check_number(field, value, what, lambda v: v > 0.0)


def check_not_negative(field: str, value: object, what: str = "a number not below 0") -> None:
    check_number(field, value, what, lambda v: v >= 0.0)


def check_vector(field: str, value: Any, size: int = 3) -> None:
    try:
        good = np.shape(value) == (size,) and bool(np.isfinite(np.asarray(value, dtype=float)).all())
    except (TypeError, ValueError):
        good = False
    if not good:
        raise FieldError(field, f"{size} finite numbers", value)


def check_whole(field: str, value: object) -> None:
    if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < 1:
        raise FieldError(field, "a whole number of at least 1", value)


def check_choice(field: str, value: object, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise FieldError(field, f"one of {', '.join(choices)}", value)


def check_type(field: str, value: object, types: tuple[type, ...]) -> None:
    if not isinstance(value, types):
        raise FieldError(field, " or ".join(t.__name__ for t in types), type(value).__name__)
