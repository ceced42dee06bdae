"""Finite linear viscoelasticity with a Prony series, isochoric.

Simo, Comput. Methods Appl. Mech. Eng. 60, 1987; Holzapfel, Nonlinear Solid Mechanics, 2000, chapter 6.

    S = S_vol + g_inf S_iso + sum Q_i,    dQ_i/dt + Q_i/tau_i = g_i dS_iso/dt

with S_iso = 2 dW/dC of the isochoric energy with the law's parameters (including softening and fibres, if
any). If the law's modulus is the long-time modulus, g_inf = 1 and the instantaneous shear modulus is
G (1 + sum g_i). If it is the instantaneous modulus, g_inf = 1 - sum g_i. The g_i are fractions of the law's
modulus in both cases.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from tisim._checks import FieldError, check_choice
from tisim.parts._part import Spectrum, Viscosity


@dataclass(frozen=True, kw_only=True)
class Prony(Viscosity):
    """A Prony series on the isochoric stress.

    Attributes
    ----------
    fractions : tuple of float
        g_i of each term, as fractions of the law's modulus; 0 or more.
    times : tuple of float
        Relaxation times tau_i [s], above 0, all different.
    modulus : "long-time" or "instantaneous"
        Meaning of the law's modulus: the long-time modulus (g_i may have any sum) or the instantaneous
        modulus (g_i sum to less than 1).
    """

    name: ClassVar[str] = "prony"
    title: ClassVar[str] = "Prony series"
    units: ClassVar[Mapping[str, str]] = {"times": "s"}

    fractions: tuple[float, ...]
    times: tuple[float, ...]
    modulus: Literal["long-time", "instantaneous"] = "long-time"

    def check(self) -> None:
        fractions = _numbers("fractions", self.fractions, "parts of the modulus, 0 or more", lowest=0.0)
        times = _numbers("times", self.times, "relaxation times above 0 s", lowest=np.nextafter(0.0, 1.0))
        if len(fractions) != len(times):
            raise FieldError("times", f"as many as there are fractions, {len(fractions)}", self.times)
        if len(np.unique(times)) < len(times):
            raise FieldError("times", "relaxation times of which no two are alike", self.times)
        check_choice("modulus", self.modulus, ("long-time", "instantaneous"))
        if self.modulus == "instantaneous" and fractions.sum() >= 1.0:
            wanted = "parts of the instantaneous modulus that sum to less than 1"
            raise FieldError("fractions", wanted, self.fractions)

    def spectrum(self) -> Spectrum:
        strengths = np.array(self.fractions, dtype=float)
        left = 1.0 if self.modulus == "long-time" else 1.0 - float(strengths.sum())
        return Spectrum(equilibrium=left, strengths=strengths, times=np.array(self.times, dtype=float))


def _numbers(field: str, values: Any, expected: str, *, lowest: float) -> np.ndarray:
    """The values as an array; FieldError unless there is at least one and all are finite and >= `lowest`."""
    try:
        found = np.array([float(v) for v in values]) if isinstance(values, Sequence | np.ndarray) else None
    except (TypeError, ValueError):
        found = None
    if found is None or not found.size or not np.isfinite(found).all() or (found < lowest).any():
        raise FieldError(field, f"one or more {expected}", values)
    return found
