"""Diagnoses for the page's tests: the real search on a linear simulator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, Literal

import numpy as np

from calibration.diagnosis import Candidate, Diagnosis, Effect, Rules, diagnose
from calibration.diagnosis.engine.held_out import HeldOut
from calibration.measurements._baseline import Baseline
from calibration.measurements._design import Gauge
from calibration.measurements._effect import EffectModel
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._state import Linearisation, State
from calibration.parameters import parametrisation

ROWS = 80
Kind = Literal["none", "found", "ambiguous", "unexplained"]

LEVELS = ("material", "specimen", "trial")


def effect(
    name: str, parameter: str, belongs_to: str = "specimen", *, prior_scale: float = 100.0
) -> EffectModel:
    about = Effect(
        name=name,
        parameter=parameter,
        per_unit=1e3 if parameter.endswith("_mm") else 1.0,
        belongs_to=belongs_to,  # type: ignore[arg-type]
        sentence=f"the beam has too much {name}",
        remedy=f"take the {name} away",
    )
    return EffectModel(effect=about, step=0.1, bounds=(-50.0, 50.0), prior_scale=prior_scale)


class LinearModel(MeasurementModel):
    """z = offset + A u + sum of amplitudes times columns.

    For the kind "ambiguous" the column of `twin` is almost parallel to that of `bend`; the column of `blind`
    is that of a modulus.
    """

    kind = "made"
    unit = ("mm", 1e3)
    experiments = (Gauge(name="turn", sentence="turn it over", sds={"bend": 1e-3}),)

    def __init__(self, kind: Kind, *, place: str = "S0") -> None:
        draws = np.random.default_rng(5)
        basis, _ = np.linalg.qr(draws.standard_normal((ROWS, 8)))
        self.effects: Mapping[str, EffectModel] = {
            "bend": effect("bend", "curvature_per_m"),
            "twin": effect("twin", "slip_mm", "rig"),
            "lens": effect("lens", "per_m2", "camera"),
            "coarse-mesh": effect("coarse-mesh", "share", "simulator", prior_scale=1.0),
            "blind": effect("blind", "excess"),
        }
        apart = 0.02 if kind == "ambiguous" else 0.9
        column = {
            "bend": basis[:, 2],
            "twin": np.sqrt(1.0 - apart**2) * basis[:, 2] + apart * basis[:, 3],
            "lens": basis[:, 4],
            "coarse-mesh": basis[:, 5],
            "blind": basis[:, 0],  # also the column of a coordinate
        }
        self.candidates = (
            *(Candidate(effect=n) for n in self.effects),
            Candidate(effect="lens", at=place, alternatives=3),
        )
        self.columns = {c: column[c.effect] * (0.8 if c.at != "all" else 1.0) for c in self.candidates}
        names = (place, "S1")
        self.baseline = Baseline(
            specimens=names, owners=names, law=parametrisation("neo-hookean"), bulk_ratio=300.0
        )
        self.noise = Noise.independent(np.ones(ROWS))
        self.records = (
            SimpleNamespace(
                name="one", material=place, specimen=place, groups=dict.fromkeys(LEVELS, place), ranges={}
            ),
        )
        self.row_record, self.visible = np.zeros(ROWS, dtype=np.intp), {}
        self.by_u, self.odd = basis[:, :2], basis[:, 6]
        signal = {"none": 0.0, "unexplained": 15.0 * self.odd}.get(kind, 15.0 * column["bend"])
        self.offset = draws.standard_normal(ROWS) + signal
        self.place = place

    def start(self) -> np.ndarray:
        return np.array([10.0, 10.5])

    def residuals(self, states: Sequence[State]) -> np.ndarray:
        return np.array([self._z(s) for s in states])

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linearisation:
        columns = np.array([self.columns[c] for c in candidates]).reshape(len(candidates), ROWS).T
        return Linearisation(
            state=state, z=self._z(state), by_u=self.by_u, columns=columns, candidates=tuple(candidates)
        )

    def update_nuisances(self, state: State, *, rough: bool = False) -> None:
        del state, rough

    def discrepancy_basis(self) -> Mapping[str, np.ndarray]:
        return {"odd bends": self.odd[:, None], "drifts": np.eye(ROWS)[:, :3]}

    def distance_rms(self, state: State) -> float:
        return 1e-4 * float(np.sqrt(np.mean(self._z(state) ** 2)))

    def noise_rms(self) -> float:
        return 1e-4

    def _misfit(self, states: Sequence[State]) -> np.ndarray:
        return np.array([1e-4 * self._z(s) for s in states])

    def _discrepancies(self) -> Mapping[str, np.ndarray]:
        raise NotImplementedError

    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        return {}

    def remarks(self) -> list[str]:
        return [f"a remark on <{self.place}>"]

    def _z(self, state: State) -> np.ndarray:
        moved = sum((a * self.columns[c] for c, a in state.amplitudes.items()), np.zeros(ROWS))
        return np.asarray(self.offset + self.by_u @ (state.u - self.start()) + moved)


def diagnosis(kind: Kind, *, place: str = "S0") -> tuple[Diagnosis, LinearModel]:
    """Diagnosis with this verdict, with an invented held-out improvement if it has a cause, and its model."""
    model = LinearModel(kind, place=place)
    made = diagnose(model, rules=Rules(seed=1), gain=False)
    assert made.finding.verdict == kind
    if made.extended is None:
        return made, model
    gain = HeldOut(
        held_out="leave-one-length-out",
        kept=0.6543,
        rms_before=3.21e-4,
        rms_after=1.05e-4,
        rms_noise=1.01e-4,
        log_likelihood=87.6,
        folds=3,
    )
    return replace(made, held_out=gain), model


def numbers(told: Any) -> list[float]:
    """All numbers in a JSON value."""
    if isinstance(told, Mapping):
        return [v for part in told.values() for v in numbers(part)]
    if isinstance(told, list):
        return [v for part in told for v in numbers(part)]
    return [float(told)] if isinstance(told, int | float) else []
