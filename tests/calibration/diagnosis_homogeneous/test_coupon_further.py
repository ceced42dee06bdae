"""Causes that are asked only where the usual ones do not explain the data, on data of another maker."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.blind.coupons.cases import make_coupon, write
from benchmarks.blind.coupons.model import FURTHER
from calibration import api


def made(folder: Path, name: str, seed: int, target: float = 60.0) -> Path:
    write(make_coupon(seed, "one", name, target=target), folder)
    return folder


@pytest.mark.parametrize("name", FURTHER)
def test_each_is_named_where_the_usual_causes_fail(tmp_path: Path, name: str) -> None:
    folder = made(tmp_path / "made", name, seed=3)
    found = api.diagnose(folder, law="neo-hookean", gain=False)
    assert found.verdict in ("found", "ambiguous")
    assert found.causes[0]["effect"] == name
    (value,) = found.causes[0]["parameters"].values()
    (hidden,) = make_coupon(3, "one", name, target=60.0).hidden
    effect = found.diagnosis.effects[name]
    assert value["value"] == pytest.approx(effect.in_file(hidden.amplitude), abs=4.0 * value["sd"])


def test_the_usual_causes_are_asked_alone_first(tmp_path: Path) -> None:
    folder = made(tmp_path / "made", "strain-stiffening", seed=5, target=20.0)
    found = api.diagnose(folder, gain=False)
    assert not any(e.further for e in found.model.effects.values())
    assert found.causes[0]["effect"] == "strain-stiffening"
