"""A calibration as an optimiser sees it: a law's coordinates in, whitened residuals out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from calibration.parameters import Parametrisation
from tisim import Material

Array = NDArray[np.float64]


class Objective(Protocol):
    """Measurements of one material. residuals: (batch, size), whitened, so that their squared sum is
    chi-square; NaN where a material has no answer. points: how many of them are measurements."""

    @property
    def name(self) -> str: ...

    @property
    def points(self) -> int: ...

    def size(self) -> int: ...

    def residuals(self, materials: Sequence[Material]) -> Array: ...


class Linearised(Protocol):
    """An objective whose nuisances are linearised at a material; False: no answer there."""

    def linearise(self, material: Material) -> bool: ...


@dataclass(frozen=True, eq=False, kw_only=True)
class Problem:
    """One law and all measurements of one material (outlines, coupons, pokes: any mix)."""

    parametrisation: Parametrisation
    objectives: tuple[Objective, ...]

    @property
    def points(self) -> int:
        return sum(o.points for o in self.objectives)

    def linearise(self, u: ArrayLike) -> bool:
        """Take nuisances at u; False where some objective has no answer there."""
        try:
            material = self.parametrisation.material(u)
        except ValueError:
            return False
        return all(o.linearise(material) for o in self.objectives if hasattr(o, "linearise"))

    def residuals(self, U: Array) -> Array:
        """Whitened residuals of a population U (batch, n), the prior's last: (batch, m); NaN where none."""
        materials: list[Material] = []
        sound: list[int] = []
        for k, u in enumerate(U):
            try:
                materials.append(self.parametrisation.material(u))
                sound.append(k)
            except ValueError:  # outside the law's domain: no answer, as for a beam without equilibrium
                continue
        sizes = [o.size() for o in self.objectives]
        found = np.full((len(U), sum(sizes)), np.nan)
        if sound:
            found[sound] = np.concatenate([o.residuals(materials) for o in self.objectives], axis=1)
        return np.concatenate([found, self.prior_residuals(U)], axis=1)

    def prior_residuals(self, U: Array) -> Array:
        """(batch, p), one column for each coordinate with a prior."""
        centre, sd = self.parametrisation.prior()
        known = np.isfinite(sd)
        return np.asarray(((U - centre) / sd)[:, known])

    def costs(self, U: Array) -> Array:
        """Chi-square with the prior's share, (batch,); inf where there is no answer."""
        total = (self.residuals(U) ** 2).sum(axis=1)
        return np.where(np.isfinite(total), total, np.inf)
