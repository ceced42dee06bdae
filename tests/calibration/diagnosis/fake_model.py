"""Measurement model whose simulator is a formula, for tests of the engine's search without FEM.

It has two materials with three lengths each and 12 points on every beam. Rows are in units of their noise. A
candidate's column is a shape along the beam times a weight per length, so its similarity to others is by
design.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._baseline import Baseline
from calibration.measurements._design import Gauge
from calibration.measurements._effect import Candidate, Effect, EffectModel
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._state import Linearisation, State

Array = NDArray[np.float64]

MATERIALS = ("S0", "S1")
LENGTHS = (1.0, 2.0, 3.0)
EACH = 12
ALONG = np.linspace(0.0, 1.0, EACH)
GROUPS = [(m, n) for m in MATERIALS for n in LENGTHS]  # beams, in the order of their rows


def effect(name: str, *, bounds: tuple[float, float] = (-1e3, 1e3), prior_scale: float = 50.0) -> EffectModel:
    about = Effect(
        name=name,
        parameter="size_mm",
        per_unit=1e3,
        belongs_to="specimen",
        sentence=f"there is {name}",
        remedy=f"measure {name}",
    )
    return EffectModel(effect=about, step=1e-3, bounds=bounds, prior_scale=prior_scale)


@dataclass(frozen=True)
class Beam:
    """A record of the synthetic measurements."""

    name: str
    material: str

    @property
    def specimen(self) -> str:
        return self.material

    @property
    def groups(self) -> Mapping[str, str]:
        return {"material": self.material, "specimen": self.material, "trial": self.name}

    @property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        return {}


def column(
    shape: Callable[[Array], Array], weights: Sequence[float] = (1.0, 1.0, 1.0), material: str = "all"
) -> Array:
    """Column of one shape on every beam, weighted by length; of one material only if it is named."""
    parts = [weights[LENGTHS.index(n)] * shape(ALONG) * float(material in ("all", m)) for m, n in GROUPS]
    return np.concatenate(parts)


def by_modulus(material: str) -> Array:
    """Derivative with respect to a modulus: a sag that increases strongly with length."""
    return column(lambda x: x**2, (1.0, 3.0, 9.0), material)


def of_length(length: float) -> NDArray[np.bool_]:
    return np.repeat([n == length for _, n in GROUPS], EACH)


def of_material(material: str) -> NDArray[np.bool_]:
    return np.repeat([m == material for m, _ in GROUPS], EACH)


def waves(order: int) -> Array:
    """Smooth discrepancies common to all beams, cosines of degree 0 to order - 1, shape (m, order)."""
    return np.column_stack([column(_wave(k)) for k in range(order)])


def _wave(degree: int) -> Callable[[Array], Array]:
    return lambda x: np.asarray(np.cos(np.pi * degree * x))


# Columns of norm 1 (one sigma per unit amplitude before projection) of effects that are well separated.
def library() -> dict[str, Array]:
    raw = {
        "bend": column(lambda x: np.sin(np.pi * x)),
        "kink": column(lambda x: np.tanh(20.0 * (x - 0.3)), (1.0, 0.3, 0.0)),
        "slope": column(lambda x: x, (2.0, 1.0, 0.5)),
        "ripple": column(lambda x: np.sin(3.0 * np.pi * x), (0.2, 1.0, 1.0)),
        "slack": column(lambda x: np.cos(np.pi * x), (0.0, 0.0, 1.0)),
    }
    return {name: c / np.linalg.norm(c) for name, c in raw.items()}


@dataclass(eq=False)
class FakeModel(MeasurementModel):
    """z = prediction - data with y = by_u u + columns a, prediction = y + bent y^2; the noise is 1.

    Attributes
    ----------
    shapes : mapping of str to ndarray (m,)
        Column of each effect on all beams.
    scoped : tuple of str
        Effects that are candidates of each material too.
    hidden : ndarray (m,) or float
        Systematic error added to the data.
    no_answer : callable
        True for states without a solution.
    """

    shapes: Mapping[str, Array] = field(default_factory=library)
    effects: dict[str, EffectModel] = field(default_factory=dict)
    scoped: tuple[str, ...] = ()
    truth: Array = field(default_factory=lambda: np.array([1.0, -0.5]))
    hidden: Array | float = 0.0
    drawn: Array | float = 0.0  # realisation of the noise
    bent: float = 0.0
    shared: bool = False  # one modulus for both materials
    no_answer: Callable[[State], bool] = lambda _: False
    split: Mapping[str, Sequence[NDArray[np.bool_]]] | None = None
    max_causes: int = 3  # type: ignore[misc]

    def __post_init__(self) -> None:
        self.effects = {n: effect(n) for n in self.shapes} | dict(self.effects)
        found = []
        for name in self.shapes:
            found.append(Candidate(effect=name))
            for m in MATERIALS if name in self.scoped else ():
                found.append(Candidate(effect=name, at=m, alternatives=2))
        self.candidates = tuple(found)
        self.visible = {}
        self.records = [Beam(f"{m} {n:g}", "all" if self.shared else m) for m, n in GROUPS]
        self.row_record = np.repeat(np.arange(len(GROUPS)), EACH)
        self.baseline = Baseline.per_specimen(self.records, bulk_ratio=300.0)
        parts = [by_modulus(m) for m in MATERIALS]
        self.by_u = np.sum(parts, axis=0)[:, None] if self.shared else np.column_stack(parts)
        self.truth = np.asarray(self.truth, dtype=float)[: self.by_u.shape[1]]
        self.noise = Noise.independent(np.ones(len(self.by_u)))
        self.data = self.predicted(State(u=self.truth)) + self.hidden + self.drawn
        self.updated: list[State] = []
        self.solves = 0

    # -- the simulator --

    def column(self, c: Candidate) -> Array:
        whole = self.shapes[c.effect]
        return whole if c.at == "all" else np.where(of_material(c.at), whole, 0.0)

    def predicted(self, state: State) -> Array:
        straight = self.by_u @ state.u
        for c, a in state.amplitudes.items():
            straight = straight + self.column(c) * a
        return straight + self.bent * straight**2

    def _slope(self, state: State) -> Array:
        """d prediction / d y, shape (m, 1)."""
        flat = FakeModel.predicted(_straight(self), state)
        return (1.0 + 2.0 * self.bent * flat)[:, None]

    # -- a measurement model --

    kind = "made"
    unit = ("mm", 1e3)

    @property
    def keep(self) -> NDArray[np.bool_]:
        return self.noise.used

    def start(self) -> Array:
        return np.zeros(self.by_u.shape[1])

    def residuals(self, states: Sequence[State]) -> Array:
        self.solves += len(states)
        rows = [
            np.full(self.points, np.nan) if self.no_answer(s) else (self.predicted(s) - self.data)[self.keep]
            for s in states
        ]
        return np.array(rows)

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linearisation:
        if self.no_answer(state):
            raise ValueError("no answer there")
        slope = self._slope(state)
        columns = [self.column(c) for c in candidates]
        stacked = np.column_stack(columns) if columns else np.zeros((len(self.by_u), 0))
        return Linearisation(
            state=state,
            z=(self.predicted(state) - self.data)[self.keep],
            by_u=(slope * self.by_u)[self.keep],
            columns=(slope * stacked)[self.keep],
            candidates=tuple(candidates),
        )

    def update_nuisances(self, state: State, *, rough: bool = False) -> None:
        if not rough:
            self.updated.append(state)

    def discrepancy_basis(self) -> Mapping[str, Array]:
        return {"waves": waves(7)[self.keep]}

    def _misfit(self, states: Sequence[State]) -> Array:
        return np.array([self.predicted(s) - self.data for s in states])

    def _discrepancies(self) -> Mapping[str, Array]:
        raise NotImplementedError

    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        raise NotImplementedError

    def folds(self) -> Mapping[str, Sequence[tuple[str, NDArray[np.bool_]]]]:
        split = self.split or {
            "leave-one-length-out": [of_length(n) for n in LENGTHS],
            "leave-one-material-out": [of_material(m) for m in MATERIALS],
        }
        return {name: [(f"{k}", rows) for k, rows in enumerate(groups)] for name, groups in split.items()}

    def unconstrained(self, fold: NDArray[np.bool_]) -> NDArray[np.bool_]:
        left = self.by_u[self.keep & ~fold]
        return np.asarray(np.linalg.norm(left, axis=0) == 0.0)

    def distance_rms(self, state: State) -> float:
        return float(1e-3 * np.sqrt(np.mean(self.residuals([state])[0] ** 2)))

    def noise_rms(self) -> float:
        return 1e-3

    # -- possible next experiments --

    experiments = (Gauge(name="look", sentence="look at it", sds={}),)


def _straight(model: FakeModel) -> FakeModel:
    plain = copy(model)
    plain.bent = 0.0
    return plain


def noise(seed: int) -> Array:
    return np.random.default_rng([20261121, seed]).standard_normal(len(GROUPS) * EACH)


def sigmas(columns: Array, model: FakeModel) -> float:
    """Norm of a column with the moduli projected out: standard deviations per unit amplitude."""
    left = columns - model.by_u @ np.linalg.lstsq(model.by_u, columns, rcond=None)[0]
    return float(np.linalg.norm(left))
