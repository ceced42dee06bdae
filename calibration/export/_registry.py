"""Programs that cards can be exported to, by name."""

from __future__ import annotations

import re

from calibration.export._job import Target
from calibration.export.targets import abaqus, calculix, febio, mujoco, newton, sofa

_BUILT_IN = {t.TARGET.name: t.TARGET for t in (sofa, febio, abaqus, calculix, mujoco, newton)}
_ADDED: dict[str, Target] = {}
_NAME = re.compile(r"[a-z0-9][a-z0-9-]*")


def register(target: Target) -> Target:
    """Add a program; one of the same name that was added before is replaced.

    Raises
    ------
    TypeError
        If it is no `Target`.
    ValueError
        If its name is taken by one of calibration's own, or not of lower-case letters, digits and hyphens.
    """
    if not isinstance(target, Target):
        raise TypeError(f"target: expected a Target, got {type(target).__name__}")
    if not _NAME.fullmatch(target.name):
        raise ValueError(
            f"target: expected a name of lower-case letters, digits and hyphens, got {target.name!r}"
        )
    if target.name in _BUILT_IN:
        raise ValueError(f"target: {target.name!r} is one of calibration's own; choose another name")
    _ADDED[target.name] = target
    return target


def unregister(name: str) -> None:
    """Take out a program that was added."""
    _ADDED.pop(name, None)


def names() -> tuple[str, ...]:
    """Names of all programs, calibration's own first."""
    return tuple(_BUILT_IN) + tuple(_ADDED)


def get(name: str) -> Target:
    """The program of that name; ValueError, which names those there are, for another."""
    found = _BUILT_IN.get(name) or _ADDED.get(name)
    if found is None:
        raise ValueError(f"expected one of {', '.join(names())}")
    return found
