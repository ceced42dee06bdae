"""Adapter of a measurement model to an objective: from search coordinates of one law to whitened residuals.

`calibration.diagnosis` searches a model for causes; this adapter makes the same model, with the same noise
and corrections, an `Objective` of `calibration.inference.Problem`::

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

EXTRA_STEPS = 4  # largest number of Gauss-Newton steps of the extras in `linearise`
EXTRA_ENOUGH = 0.1  # step, in prior sd of an extra, below which these end


class ModelObjective(Generic[Model]):
    """Whitened residuals of a model of one material.

    Call `linearise` before `residuals`: it updates the model's nuisances and discretisation errors.

    The priors of the law's coordinates belong to the problem and are left out here. Extras of the baseline (a
    release time, a test's own deviation) are not coordinates of the law; they are profiled. `linearise` fits
    them (e0) at its point u0; `residuals` follow their best values to first order, e1 = e0 + E (u - u0), and
    are linear in them about these, minimised over e for each u:

        |r(u)|^2 = min_e |z(u, e1) + A (e - e1)|^2,    A = dz/de with the rows of the extras' priors.

    With e0 in place of e1 a modulus that moves puts a vibration out of phase, which A undoes to first order
    only: where a law does not fit, chi-square then falls on both sides of its minimum.

    Parameters
    ----------
    model : model of one material, with the baseline `Baseline.of_law`.
    name : name in messages.
    frozen : if True, `linearise` leaves nuisances and extras as they are.

    Raises
    ------
    ValueError
        If the model's baseline is not of one law and one material.
    """

    def __init__(self, model: Model, *, name: str, frozen: bool = False) -> None:
        baseline = model.baseline
        if not baseline.whole or len(baseline.materials) != 1:
            raise ValueError(f"{name}: expected a model of one material with the baseline Baseline.of_law")
        self.model = model
        self.name = name
        self.frozen = frozen
        self.extras = np.array([e.centre for e in baseline.extras])
        self._follow = np.zeros((len(self.extras), baseline.first_extra))
        self._at: State | None = None
        self._basis = np.zeros((self.size(), 0))

    @property
    def points(self) -> int:
        """Number of rows that are measurements."""
        return self.model.points

    def size(self) -> int:
        """Number of residuals: the measurements, and one prior row per extra."""
        return self.model.points + len(self.model.baseline.extras)

    def specimens(self) -> list[str]:
        """Specimen of each residual; "" for the priors of the extras."""
        rows = self.model.row_record[self.model.noise.used]
        own = [self.model.records[k].specimen for k in rows]
        return own + [""] * len(self.model.baseline.extras)

    def state(self, u: Array) -> State:
        """State of the model at u (n,), with the extras of the last `linearise`, which follow u."""
        if self._at is None:
            return State(u=np.concatenate([u, self.extras]))
        moved = np.asarray(u) - self._at.u[: self.model.baseline.first_extra]
        return State(u=np.concatenate([u, self.extras + self._follow @ moved]))

    def linearise(self, u: Array, *, rough: bool = False) -> bool:
        """Update nuisances, discretisation errors and extras at u (n,); False if u has no solution.

        With `rough`, for a u that may be far from the data, the extras stay at their centres: they would take
        the whole misfit upon themselves, by thousands of their standard deviations.
        """
        if self.frozen:
            return True
        if rough:
            self._at = None
        try:
            self.model.update_nuisances(self.state(u), rough=rough)
            if not rough:
                self._take_extras(u)
        except ValueError:
            return False
        return True

    def suggested_start(self) -> Array | None:
        """Coordinates (n,) of the law near which a fit must start, if the model has any; sets the extras too.

        ValueError if the model has no solution anywhere.
        """
        found = self.model.suggested_start()
        if found is None:
            return None
        first = self.model.baseline.first_extra
        self.extras = found[first:]
        return found[:first]

    def residuals(self, U: Array) -> Array:
        """Whitened residuals (batch, size), priors of the extras last; NaN for a point without a solution."""
        rows = self._own(self.model.residuals([self.state(u) for u in U]))
        if not len(self.extras):
            return rows
        return np.asarray(rows - (rows @ self._basis) @ self._basis.T)

    def subset(self, fold: Rows, *, others: bool = False) -> Self:
        """Objective of the measurements of a fold, or of all others; its nuisances and extras are frozen."""
        part = type(self)(self.model.subset(fold, others=others), name=self.name, frozen=True)
        part.extras = self.extras
        if self._at is not None and part.points:
            part._linearise_extras(self._at)
        return part

    def nuisances(self, u: Array) -> Mapping[str, float]:
        """Most likely value of each named nuisance, in its sd. ValueError if u has no solution."""
        return self.model.nuisance_values(self.state(u))

    def shortcomings(self) -> list[str]:
        """Sentences on deficiencies of the simulation."""
        return self.model.shortcomings()

    def _take_extras(self, u: Array) -> None:
        """Fit the extras at fixed coordinates u of the law."""
        if not len(self.extras):
            return
        sds = np.array([e.sd for e in self.model.baseline.extras])
        self.extras = self.state(u).u[self.model.baseline.first_extra :]
        self._at = None
        for _ in range(EXTRA_STEPS):
            step = self._linearise_extras(self.state(u))
            if np.abs(step / sds).max() < EXTRA_ENOUGH:
                break
            self.extras = self.extras + step

    def _linearise_extras(self, state: State) -> Array:
        """Update the derivatives by the extras at a state; return their Gauss-Newton step, shape (e,)."""
        found = self.model.linearise(state, ())
        law, columns = np.hsplit(self._own(found.by_u.T).T, [self.model.baseline.first_extra])
        wanted = np.column_stack([self._own(found.z[None])[0], law])
        step = -np.linalg.lstsq(columns, wanted, rcond=None)[0]
        self._at = state
        self._basis = np.linalg.qr(columns)[0]
        self._follow = step[:, 1:]
        return np.asarray(step[:, 0])

    def _own(self, rows: Array) -> Array:
        """Residuals (batch, m) of the model, without the rows of the priors of the law and of specimens."""
        priors = len(self.model.baseline.prior) - len(self.model.baseline.extras)
        first = self.model.points
        return np.concatenate([rows[:, :first], rows[:, first + priors :]], axis=1)
