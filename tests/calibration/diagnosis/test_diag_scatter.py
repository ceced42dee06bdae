"""Scatter that the data show: noise from point to point, and what differs between repeats of a test."""

from __future__ import annotations

import numpy as np
import pytest
from fake_model import FakeModel, noise

from calibration.diagnosis.engine.run import diagnose
from calibration.measurements._noise_known import NoiseKnown, PointNoise, roughness
from calibration.measurements._variance_components import Curve, deviations, variance_components


def test_white_noise_is_seen_on_a_smooth_curve() -> None:
    x = np.linspace(0.0, 1.0, 400)
    draws = np.random.default_rng(1).standard_normal(400)
    sd, points = roughness(5.0 * np.exp(x) + 0.02 * draws)
    assert sd == pytest.approx(0.02, rel=0.15)
    assert points == 397
    assert roughness(np.zeros(3)) == (0.0, 0)


def test_stated_noise_that_the_data_contradict_is_said() -> None:
    def sentences(shown: float, *, stated: bool = True) -> list[str]:
        point = PointNoise(record="a", stated=stated, assumed=5e-5, shown=shown, points=100)
        return NoiseKnown(points=(point,), unit=("mm", 1e3)).sentences()

    (said,) = sentences(1e-5)
    assert "scatter by less than the lab states in 1 of 1 records: 0.01 mm from point to point" in said
    assert "--noise data" in said
    assert "by more" in sentences(2e-4)[0]
    assert sentences(4e-5) == []
    assert sentences(1e-5, stated=False) == []
    assert "not known" in NoiseKnown(known=False).sentences()[0]


def test_the_noise_of_the_data_is_taken_where_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("calibration.measurements._noisy_model.FEWEST", 8)  # of 12 points per beam
    small = 0.1 * noise(6)
    stated = diagnose(FakeModel(drawn=small), gain=False)
    assert stated.finding.verdict == "none"
    assert any("less than the lab states" in n for n in stated.notes)
    assert stated.to_json()["noise"]["source"] == "stated"
    model = FakeModel(drawn=small)
    known = model.settle_noise("data")
    assert known.source == "data"
    assert np.median(model.noise.sd) == pytest.approx(0.1, rel=0.4)


def repeat(
    n: int,
    x: np.ndarray,
    branch: np.ndarray,
    misfit: np.ndarray,
    *,
    sd: float = 0.0,
    scale: float = 1.0,
) -> Curve:
    return Curve(
        name=f"t{n}",
        material="m",
        specimen="s",
        test=0,
        x=x,
        branch=branch,
        misfit=misfit,
        sd=np.full(x.size, sd),
        scale=scale,
    )


def curves(*, trend: float, spread: float, seed: int, tests: int = 6) -> list[Curve]:
    """Repeats of a test of full scale 2, each with its own smooth deviation, and a trend with their order."""
    random = np.random.default_rng(seed)
    x = np.linspace(0.0, 1.0, 50)
    found = []
    for n in range(tests):
        own = spread * sum(
            np.sqrt(2.0) * random.standard_normal() * np.cos(np.pi * k * x) / np.sqrt(4.0)
            for k in range(1, 5)
        )
        misfit = 2.0 * (np.sin(3.0 * x) + own + trend * n / max(tests - 1, 1))
        found.append(repeat(n, x, np.zeros(x.size, dtype=np.int64), misfit, scale=2.0))
    return found


def test_repeats_show_their_scatter_beside_the_trend_of_their_order() -> None:
    found = [variance_components(curves(trend=0.05, spread=0.01, seed=k)) for k in range(20)]
    assert np.mean([f.repeat for f in found if f.repeat is not None]) == pytest.approx(0.01, rel=0.3)
    assert np.mean([f.order for f in found if f.order is not None]) == pytest.approx(0.05, rel=0.15)
    assert found[0].repeats == tuple(f"t{n}" for n in range(6))
    assert "6 repeats differ by" in found[0].sentences()[0]
    assert variance_components(curves(trend=0.0, spread=0.01, seed=1, tests=3)).repeat is None
    assert variance_components([]).sentences() == []


def test_a_loop_of_loading_and_unloading_is_no_scatter_between_repeats() -> None:
    """Similar repeats, sampled at other strains, with a misfit of +h in loading and -h in unloading."""
    random = np.random.default_rng(0)
    found = []
    for n in range(5):
        x = np.concatenate([np.sort(random.uniform(0, 1, 40)), np.sort(random.uniform(0, 1, 40))[::-1]])
        branch = np.repeat([0, 1], 40)
        misfit = np.where(branch == 0, 0.1, -0.1) + 0.001 * (n % 2)
        found.append(repeat(n, x, branch, misfit))
    scatter = variance_components(found).repeat
    assert scatter is not None
    assert 0.0 < scatter < 0.002


def test_noise_from_point_to_point_is_not_scatter_between_repeats() -> None:
    """Identical tests with white noise of 2 %, and the same with a scatter of 3 % between them."""
    x, branch = np.linspace(0.0, 1.0, 60), np.zeros(60, dtype=np.int64)
    alike, apart = [], []
    for seed in range(20):
        random = np.random.default_rng(seed)
        noisy = [0.02 * random.standard_normal(60) for _ in range(6)]
        alike.append(variance_components([repeat(n, x, branch, z, sd=0.02) for n, z in enumerate(noisy)]))
        moved = [z + 0.03 * random.standard_normal() for z in noisy]
        apart.append(variance_components([repeat(n, x, branch, z, sd=0.02) for n, z in enumerate(moved)]))
    assert sum(f.repeat == 0.0 for f in alike) >= 18
    assert sum(f.order is None for f in alike) >= 18
    assert "6 repeats differ by no more than the noise" in alike[0].sentences()[0]
    assert np.median([f.repeat for f in apart if f.repeat is not None]) == pytest.approx(0.03, rel=0.3)


def test_a_records_own_deviation_is_as_large_as_repeats_differ() -> None:
    (columns,) = deviations(curves(trend=0.0, spread=0.0, seed=1, tests=1), [0.01, 0.02, 0.0, 0.005, 0.0])
    assert len(columns) == 3
    assert [np.sqrt(np.mean(c**2)) for c in columns] == pytest.approx([0.02, 0.04, 0.01], rel=0.1)


@pytest.mark.parametrize(("size", "records"), [(0.01, 8), (0.02, 8), (0.03, 12)])
def test_a_scatter_of_the_load_cell_is_found_in_full(size: float, records: int) -> None:
    """Each test has its own gain: the deviation is small in most of the curve, large at its end."""
    x, branch = np.linspace(1.0, 1.5, 40), np.zeros(40, dtype=np.int64)
    curve = (x - x**-2) / (1.5 - 1.5**-2)
    found, bends = [], []
    for seed in range(30):
        random = np.random.default_rng(seed)
        misfits = [
            size * random.standard_normal() * curve + 0.002 * random.standard_normal(40)
            for _ in range(records)
        ]
        components = variance_components([repeat(n, x, branch, m, sd=0.002) for n, m in enumerate(misfits)])
        assert components.repeat is not None
        found.append(components.repeat**2)
        bends.append(components.by_degree)
    assert np.sqrt(np.mean(found)) == pytest.approx(size * np.sqrt(np.mean(curve**2)), rel=0.15)
    # of degrees 0 to 2 alone, as the gain's
    assert np.sqrt(np.mean(np.array(bends)[:, 3:] ** 2)) < 0.1 * size
