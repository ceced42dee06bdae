"""Shared by all measurement models: noise, strokes, folds, baselines, renamed effects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from calibration.diagnosis.catalogue import ALIASES, effects_of, true_name
from calibration.errors import OptionError
from calibration.measurements._baseline import Baseline
from calibration.measurements._effect import added_to
from calibration.measurements._folds import folds_of
from calibration.measurements._kinds import kinds
from calibration.measurements._memory import Memory
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._records import strokes
from calibration.measurements._state import State
from calibration.measurements.indentation.model import IndentationModel
from calibration.parameters import parametrisation


def noisy(symmetric: bool = False) -> Noise:
    rng = np.random.default_rng(3)
    sd = rng.uniform(0.5, 2.0, 12)
    sd[4] = np.inf
    return Noise.independent(sd, symmetric=symmetric).with_nuisances(rng.standard_normal((12, 3)))


@pytest.mark.parametrize("symmetric", [False, True])
def test_whitened_residuals_have_the_chi_square_of_the_whole_covariance(symmetric: bool) -> None:
    noise = noisy(symmetric)
    r = np.random.default_rng(5).standard_normal(12)
    used = np.arange(12) != 4
    covariance = np.diag(noise.sd[used] ** 2) + noise.columns[used] @ noise.columns[used].T
    z = noise.whiten(r)
    assert z @ z == pytest.approx(r[used] @ np.linalg.solve(covariance, r[used]))
    assert noise.whiten(np.column_stack([r, 2.0 * r]))[:, 1] == pytest.approx(2.0 * z)
    # profiled form: remaining residuals over their sd, and the nuisances' most likely values
    b, left = noise.estimate(r), noise.remove(r)[used] / noise.sd[used]
    assert left @ left + b @ b == pytest.approx(z @ z)


def test_correlated_noise_is_that_of_its_covariance() -> None:
    rng = np.random.default_rng(7)
    root = rng.standard_normal((6, 6))
    noise = Noise.correlated(root @ root.T).with_nuisances([rng.standard_normal(6)])
    r = rng.standard_normal(6)
    covariance = root @ root.T + noise.columns @ noise.columns.T
    z = noise.whiten(r)
    assert z @ z == pytest.approx(r @ np.linalg.solve(covariance, r))
    some = noise.subset(np.arange(6) < 4)
    assert some.points == 4
    part = some.whiten(r)
    assert part @ part == pytest.approx(r[:4] @ np.linalg.solve(covariance[:4, :4], r[:4]))


def test_the_noise_that_is_left_is_what_draws_of_it_leave() -> None:
    noise = noisy()
    rng = np.random.default_rng(11)
    used = noise.used
    squares = []
    for _ in range(4000):
        drawn = np.where(used, noise.sd, 0.0) * rng.standard_normal(12) + noise.columns @ rng.standard_normal(
            3
        )
        squares.append(np.sum(noise.remove(drawn)[used] ** 2))
    assert np.mean(squares) == pytest.approx(noise.removed_variance(), rel=0.05)


def test_a_memory_asks_once_and_forgets_the_oldest() -> None:
    memory: Memory[int, int] = Memory(3)
    asked: list[int] = []

    def squares(keys: Sequence[int]) -> list[int]:
        def answer(some: Sequence[int]) -> list[int]:
            asked.extend(keys[k] for k in some)
            return [keys[k] ** 2 for k in some]

        return memory.fetch(keys, answer)

    assert squares([1, 2, 1]) == [1, 4, 1]
    assert squares([2, 3]) == [4, 9]
    assert asked == [1, 2, 3]
    assert squares([5, 6, 7, 8, 1]) == [25, 36, 49, 64, 1]  # more than the cache keeps
    assert squares([2]) == [4]
    assert asked == [1, 2, 3, 5, 6, 7, 8, 2]


@dataclass(frozen=True, kw_only=True)
class Spring:
    name: str
    material: str
    specimen: str

    @property
    def groups(self) -> Mapping[str, str]:
        return {"material": self.material, "specimen": self.specimen}

    @property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        return {}


class Springs(MeasurementModel):
    """Three springs, one per specimen, with force u^2 for lengths up to 1; beyond, there is no solution."""

    kind = "springs"

    def __init__(self) -> None:
        self.records = [
            Spring(name=n, material="steel" if n != "b" else "brass", specimen=n) for n in ("a", "b", "c")
        ]
        self.row_record = np.array([0, 0, 1, 2])
        self.baseline = Baseline.per_specimen(self.records, bulk_ratio=300.0)
        self.noise = Noise.independent(np.ones(4))
        self.effects, self.visible = {}, {}
        self.asked = 0

    def start(self) -> np.ndarray:
        return np.zeros(3)

    def _misfit(self, states: Sequence[State]) -> np.ndarray:
        self.asked += len(states)
        u = np.array([s.u for s in states])[:, self.row_record]
        return np.where(u > 1.0, np.nan, u**2)

    def _discrepancies(self) -> dict[str, np.ndarray]:
        return {}

    def _fold_labels(self) -> dict[str, list[str]]:
        return {}


def test_a_difference_goes_to_the_side_that_has_an_answer_for_its_own_coordinate_alone() -> None:
    model = Springs()
    by_u = model.linearise(State(u=np.array([0.5, 1.0, 0.2])), ()).by_u
    h = model.coordinate_step
    expected = np.zeros((4, 3))
    expected[[0, 1], 0], expected[2, 1], expected[3, 2] = 1.0 + h, 2.0 - h, 0.4 + h
    assert by_u[:4] == pytest.approx(expected, abs=1e-9)
    assert model.asked == 3  # the state itself, all springs longer, all shorter


def test_strokes_are_cut_where_a_record_turns_by_more_than_its_noise() -> None:
    out = np.linspace(0.0, 1.0, 50)
    driven = np.concatenate([out, out[-2::-1], out[1:]])
    wobble = 0.02 * np.random.default_rng(2).standard_normal(driven.size)
    found = strokes(driven + wobble, 0.15)
    assert [s.direction for s in found] == [1.0, -1.0, 1.0]
    assert [s.points.start for s in found][1:] == pytest.approx([49, 98], abs=4)
    assert found[-1].points.stop == driven.size
    assert [s.direction for s in strokes(0.01 * wobble, 0.15)] == [0.0]


def test_folds_are_of_labels_that_part_the_rows_anew() -> None:
    labels = {"trial": ["a", "a", "b"], "material": ["x", "x", "x"], "mode": ["u", "u", "p"]}
    found = folds_of(labels)
    assert list(found) == ["trial"]
    assert [(name, rows.tolist()) for name, rows in found["trial"]] == [
        ("a", [True, True, False]),
        ("b", [False, False, True]),
    ]


@dataclass(frozen=True)
class Piece:
    material: str
    specimen: str


def test_a_fit_and_a_diagnosis_are_two_baselines_of_one_material() -> None:
    """The same shear modulus and K/G in the coordinates of both give the same material."""
    pieces = [Piece("A", "one"), Piece("A", "two")]
    each = Baseline.per_specimen(pieces, bulk_ratio=300.0)
    law = parametrisation("neo-hookean")
    whole = Baseline.of_law(pieces, law)
    assert each.names == ("one", "two")
    assert whole.names == law.names
    u = each.start({"one": 2e4, "two": 2e4})
    v = whole.start({"one": 2e4, "two": 2e4})
    for name in ("one", "two"):
        a, b = each.material(name, u).parameters, whole.material(name, v).parameters
        assert a == pytest.approx(b)
    assert each.shear_moduli(u) == pytest.approx({"A": 2e4})
    assert whole.shear_moduli(v) == pytest.approx({"A": 2e4})
    assert whole.modulus_weights("A", v) @ np.array([1.0, 0.0]) == pytest.approx(1.0)
    assert each.modulus_weights("A", u) == pytest.approx([0.5, 0.5])
    # a fit has the law's prior on K/G, a diagnosis the prior on the scatter of specimens
    assert each.prior.shape == (1, 2)
    assert whole.prior_residuals(v) == pytest.approx([0.0])


def test_one_name_has_one_meaning() -> None:
    """An effect shared by several measurements is one entry of the catalogue."""
    known: dict[str, object] = {}
    for kind in kinds():
        for name, model in effects_of(kind).items():
            assert known.setdefault(name, model.effect) is model.effect, (kind, name)


def test_names_of_earlier_versions_are_understood() -> None:
    for kind, names in ALIASES.items():
        for old, new in names.items():
            assert old not in effects_of(kind)
            assert true_name(kind, old) == new
            assert new in effects_of(kind)
    assert true_name("outlines", "radius") == "radius"


def test_a_model_of_one_law_refuses_another_in_a_sentence() -> None:
    """For a measurement that takes `--law` but has one law: commands print the sentence, exit code 2."""
    model = IndentationModel.__new__(IndentationModel)
    with pytest.raises(OptionError, match="indentation has one law only") as refused:
        model.with_law("ogden", 2)
    assert refused.value.option == "--law ogden:2: indentation has one law only, expected auto"


@dataclass(frozen=True, kw_only=True)
class Clamp:
    tilt: float = 0.1
    sag: float = 0.2


@dataclass(frozen=True, kw_only=True)
class Bar:
    length: float = 1.0
    material: str = "M"
    clamp: Clamp = Clamp()


def test_an_amplitude_is_added_to_one_number_alone() -> None:
    assert added_to(Bar, "length")(Bar(), 0.5, None) == Bar(length=1.5)
    assert added_to(Bar, "clamp.sag")(Bar(), 0.5, None) == Bar(clamp=Clamp(sag=0.7))


@pytest.mark.parametrize("path", ["lenght", "clamp.lenght", "length.tilt", "tilt"])
def test_a_number_that_does_not_exist_is_refused_where_the_effect_is_defined(path: str) -> None:
    with pytest.raises(ValueError, match=f"Bar: no field {path}"):
        added_to(Bar, path)


@pytest.mark.parametrize("path", ["material", "clamp"])
def test_an_amplitude_is_added_to_no_text_or_group(path: str) -> None:
    with pytest.raises(ValueError, match=f"expected a number in {path}"):
        added_to(Bar, path)
