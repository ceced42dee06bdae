"""Parts and search coordinates from outside the package, in fits of several laws and in their stores."""

from __future__ import annotations

import linecache
import runpy
from pathlib import Path

import numpy as np
import pytest
from _folders import coupon_entry, write_experiment

import calibration
import calibration.parameters as parameters
from calibration.experiment import read
from calibration.parameters import _parts, mullins
from calibration.parameters._laws import ogden
from calibration.study import tasks_for

COORDINATES = """
from dataclasses import replace

import calibration.parameters as parameters

def make(terms):
    p = FORMER(terms)
    return replace(p, coordinates=tuple(replace(c, high=0.9 * HIGH * c.high) for c in p.coordinates))

FORMER = parameters._REGISTERED["ogden"]
parameters.register("ogden", make)
"""


def test_search_coordinates_of_ones_own_stay_in_this_process_and_are_part_of_the_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another process would search those of the package, and a fit with others went on unnoticed."""
    table = {"stretch": np.linspace(1.0, 1.5, 8), "nominal_stress_kPa": np.linspace(0.0, 9.0, 8)}
    own = read(write_experiment(tmp_path / "data", [coupon_entry("pull", "a.csv")], tables={"a.csv": table}))
    materials = [own.trials[0].material]
    codes = []
    for high in ("1.0", "0.9"):
        monkeypatch.setattr(parameters, "_REGISTERED", {"ogden": ogden})
        path = tmp_path / "own.py"
        path.write_text(COORDINATES.replace("HIGH", high))
        linecache.checkcache()
        runpy.run_path(str(path))
        (task,) = tasks_for(own, law_names=["ogden"], materials=materials, folder=tmp_path / "fits")
        assert task.is_added
        codes.append(task.store().header["code"])
    assert codes[0] != codes[1]
    (task,) = tasks_for(own, law_names=["neo-hookean"], materials=materials, folder=tmp_path / "fits")
    assert not task.is_added


def test_a_part_of_ones_own_is_fitted_beside_several_laws(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each law in a process of its own did not know the part."""
    monkeypatch.setattr(_parts, "_KINDS", dict(_parts._KINDS))
    own = _parts.one_form(
        "my-softening",
        option="damage",
        field="softening",
        coordinates=(mullins.R, mullins.M, mullins.BETA),
        assemble=mullins.assemble,
        describe=mullins.describe,
    )
    parameters.register_part(own)
    ramp = np.linspace(1.0, 1.5, 12)
    stretch = np.concatenate([ramp, ramp[-2::-1]])
    table = {"stretch": stretch, "nominal_stress_kPa": 9.0 * (stretch - stretch**-2)}
    folder = write_experiment(tmp_path / "data", [coupon_entry("pull", "a.csv")], tables={"a.csv": table})
    found = calibration.fit(
        folder, model="neo-hookean,ogden", damage="my-softening", generations=3, polish=False, workers=2
    )
    assert [r.parts for r in found] == [("my-softening",), ("my-softening",)]
