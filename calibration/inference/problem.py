"""The least-squares problem of a calibration: a law's search coordinates in, whitened residuals out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from calibration.parameters import Parametrisation
from tisim import Material

Array = NDArray[np.float64]


class Objective(Protocol):
    """Measurements of one material, of any kind, in the search coordinates u (n,) of one law.

    One whose nuisances or discretisation errors are taken at a point is `Linearised` too.
    """

    @property
    def name(self) -> str:
        """For messages."""
        ...

    @property
    def points(self) -> int:
        """Number of measurements among the residuals (the others are priors of nuisances)."""
        ...

    def size(self) -> int:
        """Number of residuals."""
        ...

    def residuals(self, U: Array) -> Array:
        """Whitened residuals of a population U (batch, n), shape (batch, size): their squared sum is
        chi-square; NaN where a point has no answer."""
        ...


@runtime_checkable
class Linearised(Protocol):
    """An objective whose nuisances are linearised at a point, before residuals are asked for."""

    def linearise(self, u: Array, *, rough: bool = False) -> bool:
        """Take nuisances at u (n,); False where it has no answer. rough : what is dear may be left out."""
        ...


@runtime_checkable
class Suggesting(Protocol):
    """An objective that may know where a fit has to begin."""

    def suggested_start(self) -> Array | None:
        """Coordinates u (n,), or None where a scan over moduli finds a start."""
        ...


class MaterialObjective(Protocol):
    """Measurements that depend on the material alone, whatever coordinates it comes from; it may have
    `linearise(material) -> bool` too."""

    @property
    def name(self) -> str: ...

    @property
    def points(self) -> int: ...

    def size(self) -> int: ...

    def residuals(self, materials: Sequence[Material]) -> Array:
        """As `Objective.residuals`, shape (len(materials), size)."""
        ...


@dataclass(frozen=True, eq=False)
class OfMaterial:
    """An objective of materials as one of a law's search coordinates."""

    law: Parametrisation
    objective: MaterialObjective

    @property
    def name(self) -> str:
        return self.objective.name

    @property
    def points(self) -> int:
        return self.objective.points

    def size(self) -> int:
        return self.objective.size()

    def linearise(self, u: Array, *, rough: bool = False) -> bool:
        del rough
        own = getattr(self.objective, "linearise", None)
        return own is None or bool(own(self.law.material(u)))

    def residuals(self, U: Array) -> Array:
        return self.objective.residuals([self.law.material(u) for u in U])


@dataclass(frozen=True, eq=False, kw_only=True)
class Problem:
    """One law and all measurements of one material.

    Attributes
    ----------
    parametrisation : Parametrisation
        The law in search coordinates u, shape (n,).
    objectives : tuple of Objective
        Any mix of measurements.
    """

    parametrisation: Parametrisation
    objectives: tuple[Objective, ...]

    @property
    def points(self) -> int:
        return sum(o.points for o in self.objectives)

    def linearise(self, u: ArrayLike, *, rough: bool = False) -> bool:
        """Take nuisances at u; False where some objective has no answer there. rough : without what is dear,
        for a start that need not be better than a few per cent."""
        at = np.asarray(u, dtype=float)
        if not self._sound(at):
            return False
        return all(o.linearise(at, rough=rough) for o in self.objectives if isinstance(o, Linearised))

    def residuals(self, U: Array) -> Array:
        """Whitened residuals of a population U (batch, n), the prior's last: (batch, m); NaN where none."""
        # outside the law's domain there is no answer, as for a beam without equilibrium
        sound = [k for k, u in enumerate(U) if self._sound(u)]
        sizes = [o.size() for o in self.objectives]
        found = np.full((len(U), sum(sizes)), np.nan)
        if sound:
            found[sound] = np.concatenate([o.residuals(U[sound]) for o in self.objectives], axis=1)
        return np.concatenate([found, self.prior_residuals(U)], axis=1)

    def _sound(self, u: Array) -> bool:
        try:
            self.parametrisation.material(u)
        except ValueError:
            return False
        return True

    def prior_residuals(self, U: Array) -> Array:
        """(batch, p), one column for each coordinate with a prior."""
        centre, sd = self.parametrisation.prior()
        known = np.isfinite(sd)
        return np.asarray(((U - centre) / sd)[:, known])

    def costs(self, U: Array) -> Array:
        """Chi-square and the prior's term, shape (batch,); infinite where there is no answer."""
        total = (self.residuals(U) ** 2).sum(axis=1)
        return np.where(np.isfinite(total), total, np.inf)
