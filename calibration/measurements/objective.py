"""A measurement model as an objective of a fit: one law's search coordinates in, whitened residuals out.

`calibration.diagnosis` searches a model for causes; this makes the same model, with the same noise and the
same corrections, an `Objective` of `calibration.inference.Problem`::

    law = parametrisation("ogden")
    model = HomogeneousModel(experiment, baseline=Baseline.of_law(trials, law))
    problem = Problem(parametrisation=law, objectives=(ModelObjective(model, name="coupons"),))
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Generic, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]
Model = TypeVar("Model", bound=MeasurementModel)

EXTRA_STEPS = 4  # Gauss-Newton, for the extras of a baseline where nuisances are taken
EXTRA_ENOUGH = 0.1  # [sd of an extra]: a smaller step ends them


class ModelObjective(Generic[Model]):
    """Whitened residuals of a model of one material. `residuals` needs `linearise` first, which takes the
    model's nuisances and discretisation errors.

    The priors of the law's coordinates are the problem's, and left out here. Extras of the baseline (a
    release time, a test's own deviation) are no coordinates of the law: they are profiled. `linearise` moves
    them to their best at its point; around it they are linear, and their best for each u is taken out of its
    residuals, their priors counted:

        r(u) = min_e |z(u, e0) + A (e - e0)|^2,    A = dz/de with the rows of the extras' priors.

    Parameters
    ----------
    model : of one material, with the baseline `Baseline.of_law`.
    name : for messages.
    frozen : nuisances stay as the model has them, whatever is linearised.

    Raises
    ------
    ValueError : the model's baseline is not of one law and one material.
    """

    def __init__(self, model: Model, *, name: str, frozen: bool = False) -> None:
        baseline = model.baseline
        if not baseline.whole or len(baseline.materials) != 1:
            raise ValueError(f"{name}: expected a model of one material with the baseline Baseline.of_law")
        self.model = model
        self.name = name
        self.frozen = frozen
        self.extras = np.array([e.centre for e in baseline.extras])
        self._at: State | None = None
        self._basis = np.zeros((self.size(), 0))

    @property
    def points(self) -> int:
        """Rows that are measurements: as many as the model compares."""
        return self.model.points

    def size(self) -> int:
        """Number of residuals: the measurements, and one prior for each extra."""
        return self.model.points + len(self.model.baseline.extras)

    def state(self, u: Array) -> State:
        """The model's state at u (n,), extras as they were taken last."""
        return State(u=np.concatenate([u, self.extras]))

    def linearise(self, u: Array, *, rough: bool = False) -> bool:
        """Take nuisances, discretisation errors and extras at u (n,); False where it has no answer."""
        if self.frozen:
            return True
        try:
            self.model.update_nuisances(self.state(u), rough=rough)
            self._take_extras(u)
        except ValueError:
            return False
        return True

    def suggested_start(self) -> Array | None:
        """The law's coordinates (n,) near which a fit has to begin, if the model names any; extras are then
        taken from there. ValueError where the model has no answer anywhere."""
        found = self.model.suggested_start()
        if found is None:
            return None
        first = self.model.baseline.first_extra
        self.extras = found[first:]
        return found[:first]

    def residuals(self, U: Array) -> Array:
        """(batch, size): whitened residuals, the priors of extras last; NaN where a point has no answer."""
        rows = self._own(self.model.residuals([self.state(u) for u in U]))
        if not len(self.extras):
            return rows
        return np.asarray(rows - (rows @ self._basis) @ self._basis.T)

    def subset(self, fold: Rows, *, others: bool = False) -> Self:
        """The measurements of a fold, or all others; nuisances and extras stay as they were taken here,
        whatever is linearised later."""
        part = type(self)(self.model.subset(fold, others=others), name=self.name, frozen=True)
        part.extras = self.extras
        if self._at is not None and part.points:
            part._linearise_extras(self._at)
        return part

    def nuisances(self, u: Array) -> Mapping[str, float]:
        """Most likely value of each named nuisance [its sd]. ValueError where u has no answer."""
        return self.model.nuisance_values(self.state(u))

    def shortcomings(self) -> list[str]:
        """How the simulation falls short of what it should be, a sentence each."""
        return self.model.shortcomings()

    def _take_extras(self, u: Array) -> None:
        """Extras at their best beside u, the law's coordinates held."""
        if not len(self.extras):
            return
        sds = np.array([e.sd for e in self.model.baseline.extras])
        for _ in range(EXTRA_STEPS):
            step = self._linearise_extras(self.state(u))
            if np.abs(step / sds).max() < EXTRA_ENOUGH:
                break
            self.extras = self.extras + step

    def _linearise_extras(self, state: State) -> Array:
        """Take the derivatives by the extras at a state; returns the step (e,) to their best there."""
        found = self.model.linearise(state, ())
        columns = self._own(found.by_u[:, self.model.baseline.first_extra :].T).T
        self._at = state
        self._basis = np.linalg.qr(columns)[0]
        return np.asarray(-np.linalg.lstsq(columns, self._own(found.z[None])[0], rcond=None)[0])

    def _own(self, rows: Array) -> Array:
        """Residuals (batch, m) of the model without the rows of the law's own priors."""
        priors = len(self.model.baseline.prior) - len(self.model.baseline.extras)
        first = self.model.points
        return np.concatenate([rows[:, :first], rows[:, first + priors :]], axis=1)
