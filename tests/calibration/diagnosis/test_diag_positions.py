"""A cause with a position along the specimen is found there, between the screened positions."""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np
import pytest
from fake_model import ALONG, LENGTHS, MATERIALS, FakeModel, column, library, noise

from calibration.diagnosis.engine import positions
from calibration.diagnosis.engine.explain import explain
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.search import fit_baseline, search
from calibration.measurements._effect import Candidate

GRID = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)


def dent(place: float) -> np.ndarray:
    """A kink that begins at a position, in the shorter beams of one material."""
    kink = column(lambda x: np.maximum(x - place, 0.0), (3.0, 1.0, 0.0), MATERIALS[0])
    return np.asarray(kink)


@dataclass(eq=False)
class Placed(FakeModel):
    """Model with an effect "dent" that is a candidate at each position of the grid."""

    def __post_init__(self) -> None:
        self.shapes = {**library(), "dent": dent(0.5)}
        super().__post_init__()
        others = [c for c in self.candidates if c.effect != "dent"]
        grid = [Candidate(effect="dent", position=p, alternatives=len(GRID)) for p in GRID]
        self.candidates = (*others, *grid)

    def column(self, c: Candidate) -> np.ndarray:
        return dent(c.position) if c.position is not None else super().column(c)


def placed(at: float, size: float, seed: int) -> Placed:
    return Placed(hidden=size * dent(at), drawn=noise(seed))


@pytest.mark.parametrize("at", [0.14, 0.347, 0.55, 0.68])
def test_a_large_cause_between_two_places_is_found_there(at: float) -> None:
    model = placed(at, 40.0, 3)
    found = search(model)
    assert found.verdict == "found"
    assert found.chosen is not None
    (cause,) = found.chosen.candidates
    assert cause.effect == "dent"
    assert cause.position == pytest.approx(at, abs=0.02)  # the grid spacing is 0.1, that of points 0.09
    assert found.chosen.lack_of_fit.p_value > 0.01
    assert cause in found.screened.candidates


def test_left_at_its_grid_the_cause_would_not_be_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the refinement of the position the verdict is "unexplained"."""
    module = sys.modules["calibration.diagnosis.engine.search"]  # the package has a function with this name
    monkeypatch.setattr(module, "at_best_position", lambda _model, explanation, _null: explanation)
    assert search(placed(0.347, 40.0, 3)).verdict == "unexplained"


def test_a_second_cause_beside_it_is_found_as_well() -> None:
    shapes = library()
    model = Placed(hidden=40.0 * dent(0.347) + 20.0 * shapes["ripple"], drawn=noise(4))
    found = search(model)
    assert found.verdict == "found"
    assert found.chosen is not None
    assert found.chosen.names == ("dent", "ripple")
    (cause,) = (c for c in found.chosen.candidates if c.effect == "dent")
    assert cause.position == pytest.approx(0.347, abs=0.02)


def test_what_has_no_place_stays_as_it_is() -> None:
    model = FakeModel(hidden=20.0 * library()["bend"], drawn=noise(5))
    null = Null(len(model.data), {}, seed=0)
    bend = explain(model, fit_baseline(model), (Candidate(effect="bend"),), [10.0], null)
    assert bend is not None
    assert positions.at_best_position(model, bend, null) is bend


def test_noise_seldom_makes_a_cause_of_many_places() -> None:
    verdicts = [search(Placed(drawn=noise(500 + k))).verdict for k in range(60)]
    assert sum(v != "none" for v in verdicts) <= 5
    assert len(LENGTHS) * len(ALONG) * len(MATERIALS) == len(noise(0))
