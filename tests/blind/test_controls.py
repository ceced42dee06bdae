"""Controls of verdicts: true fractions, cases with one cause inside and one outside the library, scores."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from benchmarks.blind.beams.cases import resized, solve_case
from benchmarks.blind.beams.detectability import columns_at
from benchmarks.blind.beams.laboratory import STEP, Made, ideal
from benchmarks.blind.beams.model import Resolution
from benchmarks.blind.beams.store import CASES, load_case, load_truth
from benchmarks.blind.compression import SHEAR_MODULI
from benchmarks.blind.compression import laboratory as compression
from benchmarks.blind.controls import LABORATORIES, covered, scores
from benchmarks.blind.laboratory import WAVES, left, shapley

RECORDS = {"coupons": 1, "compression": 1, "indentation": 2}  # column of the measured quantity
STATED = ("stress_sd_kPa", "force_sd_N")
RNG = np.random.default_rng(1)
COLUMNS = {n: RNG.standard_normal(40) for n in "abc"}
FREE = RNG.standard_normal((40, 2))


def test_shares_add_up_whatever_the_order() -> None:
    departure = COLUMNS["a"] + 0.5 * COLUMNS["b"] + COLUMNS["c"]
    shares = shapley(departure, FREE, COLUMNS)
    assert sum(shares.values()) == pytest.approx(1.0)
    two = shapley(departure, FREE, {n: COLUMNS[n] for n in "ab"})
    columns = np.column_stack([FREE, COLUMNS["a"], COLUMNS["b"]])
    assert sum(two.values()) == pytest.approx(1.0 - left(columns, departure) / left(FREE, departure))
    again = shapley(departure, FREE, {n: COLUMNS[n] for n in "ba"})
    assert again == pytest.approx(two)


def test_orthogonal_causes_have_the_shares_of_their_squares() -> None:
    unit = np.eye(5)
    shares = shapley(3.0 * unit[1] + unit[2] + 9.0 * unit[0], unit[:, :1], {"a": unit[1], "b": unit[2]})
    assert shares == pytest.approx({"a": 0.9, "b": 0.1})


@pytest.mark.parametrize(("kind", "seed"), [("coupons", 7), ("compression", 8), ("indentation", 9)])
def test_half_and_half(kind: str, seed: int) -> None:
    """One cause inside and one outside the library, of the same size."""
    lab = LABORATORIES[kind]
    case = next(c for k in range(20) if (c := lab.half(1000 * seed + k, 25.0)) is not None)
    inside, outside = lab.hidden(case)
    assert inside.sigma == pytest.approx(outside.sigma, rel=0.3)
    share = lab.true_shares(case, [inside.name])[inside.name]
    assert 0.0 < share < 1.0


@pytest.mark.parametrize("kind", [*RECORDS, "release"])
def test_one_cause_alone_has_all(kind: str) -> None:
    lab = LABORATORIES[kind]
    case = lab.one(3, 25.0)
    (hidden,) = lab.hidden(case)
    assert hidden.sigma == pytest.approx(25.0, rel=0.25)
    assert lab.true_shares(case, [hidden.name]) == pytest.approx({hidden.name: 1.0})


@pytest.mark.parametrize("kind", list(RECORDS))
def test_a_smooth_error_is_small_and_not_stated(kind: str, tmp_path: Path) -> None:
    lab = LABORATORIES[kind]
    lab.write(lab.clean(5), tmp_path / "plain")
    lab.write(lab.clean(5), tmp_path / "smooth")
    lab.smooth_error(tmp_path / "smooth", 5)
    trials = yaml.safe_load((tmp_path / "smooth" / "experiment.yaml").read_text(encoding="utf-8"))["trials"]
    for trial in trials:
        assert not set(STATED) & set(trial)
        plain, smooth = (
            np.loadtxt(tmp_path / which / trial["record"], delimiter=",", skiprows=1)
            for which in ("plain", "smooth")
        )
        error = (smooth - plain)[:, RECORDS[kind]] / np.abs(plain[:, RECORDS[kind]]).max()
        assert 0.002 < np.sqrt(np.mean(error**2)) < 0.011
        assert np.abs(np.diff(error)).max() < 0.2 * np.ptp(error)  # smooth, without jumps
        others = np.arange(plain.shape[1]) != RECORDS[kind]
        assert smooth[:, others] == pytest.approx(plain[:, others])


def stored(index: int) -> Made:
    case, edges = load_case(CASES, index)
    sizes = load_truth(CASES)["cases"][f"{index:03d}"]["sigma"]
    return Made(case=case, edges=edges, sizes=sizes)


def test_a_smooth_error_of_edges(tmp_path: Path) -> None:
    """It is normal to each edge, a fraction of a millimetre, and without jumps."""
    lab, made = LABORATORIES["beams"], stored(1)
    for name in ("plain", "smooth"):
        lab.write(made, tmp_path / name)
    lab.smooth_error(tmp_path / "smooth", 5)
    for path in (tmp_path / "plain" / "beams").glob("*.csv"):
        plain, smooth = (
            np.loadtxt(p, delimiter=",", skiprows=1, usecols=(1, 2))
            for p in (path, tmp_path / "smooth" / "beams" / path.name)
        )
        half = len(plain) // 2  # upper edge, then lower edge
        for edge, off in ((plain[:half], smooth[:half]), (plain[half:], smooth[half:])):
            move = off - edge
            size = np.sqrt(np.mean((move**2).sum(axis=1)))
            assert 0.04 < size < 0.16
            tangent = np.gradient(edge, axis=0)
            along = np.einsum("kc,kc->k", move, tangent) / np.hypot(*tangent.T)
            assert np.abs(along).max() < 0.05 * size  # tables have four decimals
            normal = np.einsum("kc,kc->k", move, np.stack([-tangent[:, 1], tangent[:, 0]], axis=1))
            turns = np.diff(np.sign(np.diff(normal / np.hypot(*tangent.T)))) != 0
            assert turns.sum() <= WAVES + 1  # smooth for any number of points


def test_a_smooth_error_of_markers(tmp_path: Path) -> None:
    """Each marker's height has its own error; times and lateral positions are unchanged."""
    lab = LABORATORIES["release"]
    for name in ("plain", "smooth"):
        lab.write(lab.clean(5), tmp_path / name)
    lab.smooth_error(tmp_path / "smooth", 5)
    plain, smooth = (
        np.loadtxt(tmp_path / name / "run-0.csv", delimiter=",", skiprows=1, usecols=(1, 2, 4))
        for name in ("plain", "smooth")
    )
    assert np.array_equal(plain[:, :2], smooth[:, :2])
    errors = (smooth - plain)[:, 2].reshape(4, -1) / np.abs(plain[:, 2]).max()
    size = np.sqrt(np.mean(errors**2, axis=1))
    assert size == pytest.approx(np.full(4, size[0]), rel=1e-6)
    assert 0.002 < size[0] < 0.011
    assert np.abs(np.diff(errors, axis=1)).max() < 0.2 * size[0]  # smooth
    assert np.abs(np.corrcoef(errors)[np.triu_indices(4, 1)]).max() < 0.99


def test_slopes_of_beams_have_the_sizes_of_their_causes() -> None:
    """For a stored case with one cause, the size by derivatives equals the size by fits."""
    lab = LABORATORIES["beams"]
    truth = load_truth(CASES)["cases"]
    index = next(int(k) for k, c in truth.items() if [h["effect"] for h in c["hidden"]] == ["added-mass"])
    made = stored(index)
    (hidden,) = lab.hidden(made)
    columns = lab.whitened(made, made.hidden)
    assert np.sqrt(left(lab.free(made), columns)) == pytest.approx(hidden.sigma, rel=0.1)
    # linearity: twice the step gives twice the displacement
    smaller = resized(made.case, (made.case.hidden[0].amplitude * (1.0 - 2.0 * STEP),))
    twice = columns_at(
        made.case, made.edges, ideal(), [(smaller, solve_case(smaller, ideal(), Resolution()))]
    )
    z = twice.causes[:, 0] / (2.0 * STEP)
    assert left(lab.free(made), z - columns) < 0.01 * left(lab.free(made), columns)


def test_one_machine_presses_both_cylinders() -> None:
    """The machine's part of the recorded strain, divided by the stress [Pa], is the same for both."""
    case = replace(compression.clean(3), count=1)
    soft = compression.Hidden(name="machine-compliance", amplitude=0.01)
    parts = []
    for material, shear in SHEAR_MODULI.items():
        plain, yielding = (-compression.stress(case, h, material) for h in ((), (soft,)))
        own = case.strain - np.interp(yielding, plain, case.strain)
        parts.append(own[10:] / (shear * yielding[10:]))
    assert np.concatenate(parts) == pytest.approx(0.01 / SHEAR_MODULI["soft"], rel=0.02)


def row(verdict: str, named: tuple[str, ...] = (), **more: Any) -> dict[str, Any]:
    share = {"value": 0.5, "low": 0.4, "high": 0.6}
    causes = [{"effect": n, "share": share} for n in named]
    nearest = {"causes": [{"effect": "b"}], "share": share} if verdict == "unexplained" else None
    return {
        "verdict": verdict,
        "causes": causes,
        "alternatives": [list(named)] if named else [],
        "share": share if named else None,
        "nearest": nearest,
        "hidden": ("b", "slip"),
        "excused": False,
        "words": ["c"],
        "true_shares": {},
        **more,
    }


def test_scores() -> None:
    done = [
        row("partly explained", ("b",), true_shares={"b": 0.55}),
        row("unexplained", true_shares={"b": 0.7}),
        row("found", ("a",)),
    ]
    assert covered(done[0]) == [True]
    assert covered(done[1]) == [False]
    half = list(scores("half", done))
    assert "1 of 3" in half[1]
    assert "2 of 3" in half[2]
    assert "1 of 2" in half[3]
    assert "2 of 3" in half[4]
    assert "3 of 4" in list(scores("half", [*done, row("found", ("c",))]))[4]
    without = list(scores("without", [*done, row("found", ("c",), excused=True)]))
    assert "1 of 4" in without[1]
    assert "1 of 4" in without[2]
    assert "2 of 4" in without[3]
    assert "1 of 3" in list(scores("smooth", done))[1]
