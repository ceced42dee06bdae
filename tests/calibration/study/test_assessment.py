"""A fit at a bound, or with a significant misfit, is no calibration: status, message, card."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from _folders import coupon_entry, write_experiment

import tisim
from calibration.experiment import read
from calibration.inference import CmaOptions, OfMaterial
from calibration.parameters import parametrisation
from calibration.study import Calibration, FitOptions, best, calibrate, card
from calibration.study.assessment import at_bounds, nuisances_lacking, off_prior, step_gains
from calibration.study.measurements import Measurements

QUICK = FitOptions(cma=CmaOptions(max_generations=25), leave_one_out=False)


class Linear:
    """Residuals linear in ln G and ln K/G with the minimum at the given values."""

    name = "linear"
    reference = None
    uncorrected = ""

    def __init__(
        self, shear_modulus: float, bulk_ratio: float, *, noise: float = 0.0, coupling: float = 0.0
    ) -> None:
        self.target = np.log([shear_modulus, bulk_ratio])
        self.rows = np.array([[40.0, 2.0], [0.0, 4.0], *np.tile([20.0, coupling], (48, 1))])
        self.noise = noise * np.random.default_rng(1).standard_normal(len(self.rows))

    @property
    def points(self) -> int:
        return len(self.rows)

    def size(self) -> int:
        return len(self.rows)

    def linearise(self, _: tisim.Material) -> bool:
        return True

    def residuals(self, materials: Sequence[tisim.Material]) -> np.ndarray:
        found = []
        for m in materials:
            moduli = tisim.laws.get(m.law).moduli(m.parameters)
            u = np.log([moduli.shear_modulus, moduli.bulk_modulus / moduli.shear_modulus])
            found.append(self.rows @ (u - self.target) + self.noise)
        return np.array(found)


def fitted(data: Linear, law: str = "neo-hookean", *, free: bool = True) -> Calibration:
    """Fit of these data; with `free`, K/G is fitted."""
    p, held = parametrisation(law), cast(Any, data)
    whole = Measurements(
        material="S0",
        law=p,
        density=1000.0,
        objectives=(OfMaterial(p, held),),
        outlines=held,
        ignored=(),
        free_bulk_ratio=free,
    )
    return calibrate(whole, options=QUICK)


def test_data_that_the_law_meets_are_a_calibration() -> None:
    found = fitted(Linear(20e3, 250.0, noise=1.0))
    assert found.status == "converged"
    assert found.lacking == ()
    assert found.shear_modulus == pytest.approx(20e3, rel=0.05)


@pytest.mark.parametrize("ratio", [0.5, 4.0])
def test_a_bulk_modulus_at_its_bound_or_far_off_its_prior(ratio: float) -> None:
    """0.5 lies beyond the bound of 3; 4 is allowed, but at 3.9 sd of the prior (ln 300 +- 1.1)."""
    found = fitted(Linear(20e3, ratio, noise=0.3))
    assert found.status == "lack of fit"
    assert found.message.startswith("the data ask for something that neo-hookean lacks (K/G ")
    assert "python -m calibration.diagnose" in found.message
    # K/G and its uncertainty are the prior's, and the shear modulus is fitted with it
    assert found.bulk_modulus / found.shear_modulus == pytest.approx(300.0, rel=0.05)
    bulk = next(e for e in found.estimates if e.name == "bulk_ratio")
    assert bulk.seen == "held"
    assert np.log(bulk.high / bulk.low) == pytest.approx(2 * 1.96 * 1.1, rel=0.1)
    assert found.unsettled == ()


def test_a_bulk_modulus_is_held_unless_it_is_asked_for() -> None:
    """It is held at the prior's centre for any data; its interval is the prior's."""
    found = fitted(Linear(20e3, 250.0, noise=0.3), free=False)
    bulk = next(e for e in found.estimates if e.name == "bulk_ratio")
    assert bulk.seen == "held"
    assert bulk.value == pytest.approx(300.0, rel=0.02)
    assert np.log(bulk.high / bulk.low) == pytest.approx(2 * 1.96 * 1.1, rel=0.1)
    asked = fitted(Linear(20e3, 250.0, noise=0.3))
    assert asked.bulk_modulus / asked.shear_modulus == pytest.approx(250.0, rel=0.1)


@pytest.mark.parametrize("free", [False, True])
def test_the_bar_of_the_shear_modulus_holds_the_priors_uncertainty(free: bool) -> None:
    """ln G changes by -s per unit of the uncertain ln K/G; s follows from the rows of the data."""
    data = Linear(20e3, 0.5, coupling=1.0)
    found = fitted(data, free=free)
    a, b = data.rows.T
    slope = (a @ b) / (a @ a)
    own = max(1.0, found.reduced_chi2) / (a @ a)
    expected = np.sqrt(own + (1.1 * slope) ** 2)
    assert found.shear_modulus_sd / found.shear_modulus == pytest.approx(expected, rel=0.02)


def test_the_card_holds_the_priors_ratio_and_says_so(tmp_path: Path) -> None:
    experiment = read(
        write_experiment(
            tmp_path,
            [coupon_entry("pull", "a.csv")],
            tables={"a.csv": {"stretch": [1.0, 1.1, 1.2], "nominal_stress_kPa": [0.0, 1.0, 2.0]}},
        )
    )
    made = card([fitted(Linear(20e3, 0.5, noise=0.3))], experiment)
    mu, lam = made["laws"]["neo-hookean"]["mu"], made["laws"]["neo-hookean"]["lam"]
    assert (lam + 2.0 * mu / 3.0) / mu == pytest.approx(300.0, rel=0.05)
    assert re.search(
        r"K/G was held at (29|30)\d, not measured: its prior's 95 % interval is 3\d to 2[56]\d\d",
        made["uncertainty"]["text"],
    )
    assert "Lack of fit:" in made["provenance"]


def test_a_constant_at_a_bound_gives_way_to_a_settled_law(tmp_path: Path) -> None:
    """Ogden fits slightly better with its exponent at a bound; the card has the law without this problem."""
    settled = fitted(Linear(20e3, 250.0))
    at_bound = replace(settled, law="ogden", label="ogden", chi2=settled.chi2 - 50.0, unsettled=("alpha",))
    assert best([at_bound, settled]) is settled
    assert best([at_bound]) is at_bound
    experiment = read(
        write_experiment(
            tmp_path,
            [coupon_entry("pull", "a.csv")],
            tables={"a.csv": {"stretch": [1.0, 1.1, 1.2], "nominal_stress_kPa": [0.0, 1.0, 2.0]}},
        )
    )
    made = card([at_bound, settled], experiment)
    (shear,) = (e for e in settled.estimates if e.name == "shear_modulus")
    assert made["uncertainty"]["shear_modulus_low"] == pytest.approx(shear.low / shear.value - 1, abs=1e-5)
    blind = replace(settled, estimates=(replace(shear, low=-1e4, seen="not identified"),))
    assert card([blind], experiment)["uncertainty"]["shear_modulus_low"] is None
    provenance = made["provenance"]
    _, _, not_fitted = provenance.partition("Not fitted")
    assert "ogden" not in not_fitted.splitlines()[0]
    assert "Fitted but not taken (not converged, or a constant at a bound): ogden." in provenance
    assert "No fit taken, moduli taken from neo-hookean: ogden." in provenance


def test_a_constant_that_is_held_takes_no_degree_of_freedom() -> None:
    held, free = fitted(Linear(20e3, 250.0), free=False), fitted(Linear(20e3, 250.0))
    assert (held.constants, free.constants) == (len(held.u) - 1, len(free.u))
    for found in (held, free):
        assert found.freedom == found.points - found.constants
        assert found.reduced_chi2 == pytest.approx(found.chi2 / found.freedom)


def test_a_bound_that_is_a_simpler_law_is_no_lack_of_fit() -> None:
    p = parametrisation("arruda-boyce")
    u = p.start(shear=2e4)
    i = p.names.index("locking")
    u[i] = p.bounds[i, 1]
    assert at_bounds(p, u) == {}
    u[i] = p.bounds[i, 0]
    assert at_bounds(p, u) == {"locking": 1.2}


def test_a_bound_counts_where_the_data_press_against_it() -> None:
    p = parametrisation("ogden")
    u = p.start(shear=2e4)
    i = p.names.index("alpha")
    u[i] = p.bounds[i, 0]
    J = np.zeros((3, 3))
    J[:, i] = 1.0
    assert at_bounds(p, u, step_gains([2.0, 2.0, 2.0], J)) == {"alpha": 0.5}
    assert at_bounds(p, u, step_gains([0.1, -0.1, 0.2], J)) == {}
    assert step_gains([2.0, 2.0, 2.0], J)[i] == pytest.approx(12.0)


def test_a_held_constant_is_no_lack_of_fit() -> None:
    p = parametrisation("neo-hookean").holding("bulk_ratio")
    u = p.start(shear=2e4)
    u[1] += 0.1  # ten sd of the prior that holds it
    assert off_prior(p, u) == {}


@pytest.mark.parametrize(
    ("values", "lacks"),
    [
        ([0.5] * 44, False),
        ([2.5] * 4 + [0.5] * 40, False),  # by chance 2 of 44 are there, sometimes 4
        ([2.5] * 8 + [0.5] * 36, True),
        ([5.5] + [0.5] * 43, True),
        ([3.0] + [0.5] * 43, False),
        ([], False),
    ],
)
def test_nuisances_beyond_chance(values: list[float], lacks: bool) -> None:
    found = nuisances_lacking({f"n{i}": v for i, v in enumerate(values)})
    assert bool(found) is lacks
    if values and values[0] == 2.5 and lacks:
        assert found == ["8 of 44 nuisances lie beyond 2 standard deviations, where chance puts about 2"]


@pytest.mark.parametrize(
    ("chi2", "status"), [(1.12, "converged"), (1.4, "converged"), (126.0, "lack of fit")]
)
def test_misfit_far_above_the_noise(chi2: float, status: str) -> None:
    good = fitted(Linear(20e3, 250.0, noise=1.0))
    assert replace(good, reduced_chi2=chi2).assessed().status == status


def test_a_modulus_in_the_wrong_unit_is_noted() -> None:
    assert "check the units" in fitted(Linear(60.0, 300.0)).note
    assert "check the units" not in fitted(Linear(500.0, 300.0)).note
