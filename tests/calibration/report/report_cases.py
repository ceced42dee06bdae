"""Synthetic calibrations and experiments for the page's tests; a planar elastica as photographed beam."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from _folders import (
    beam_entry,
    capture_entry,
    coupon_entry,
    outline_columns,
    write_experiment,
)
from hanging_beams import elastica

from calibration.inference import Estimate
from calibration.study import Calibration


def beam_folder(folder: Path) -> Path:
    """Experiment with one cantilever of 50 mm with one traced photograph, and one beam without an outline."""
    upper, lower = elastica(10e3, 0.050, at=np.linspace(0.03, 1.0, 25))
    photographs = [capture_entry(60.0, "beams/b.csv")]
    traced = beam_entry("hanging", material="S1", captures=photographs, free_length_mm=50.0)
    pixel = {"squares": [9, 6], "square_mm": 10.0}
    photo = {"time_s": 60.0, "photo": "photos/x.png", "photo_checkerboard": pixel}
    (folder / "photos").mkdir(parents=True)
    (folder / "photos" / "x.png").write_bytes(b"not read by a fit")
    return write_experiment(
        folder,
        [traced, beam_entry("untraced", material="S1", captures=[photo])],
        tables={"beams/b.csv": outline_columns(upper, lower)},
        name="a <made> experiment",
    )


def coupon_folder(folder: Path) -> Path:
    """Tensile curves of an incompressible Neo-Hookean material, G = 100 kPa, as those of two materials."""
    stretch = np.linspace(1.0, 2.0, 15)
    table = {"stretch": stretch, "nominal_stress_kPa": 100.0 * (stretch - stretch**-2)}
    return write_experiment(
        folder,
        [coupon_entry("pull-A", "a.csv", material="A"), coupon_entry("pull-B", "a.csv", material="B")],
        tables={"a.csv": table},
        materials={"A": {}, "B": {}},
    )


def calibration(label: str = "neo-hookean", *, material: str = "A", **more: Any) -> Calibration:
    """Converged fit of G = 100 kPa with an invented chi-square of 90 over 100 points."""
    mu, bulk = 1e5, 3e7
    by_law: dict[str, dict[str, Any]] = {
        "neo-hookean": {"mu": mu, "lam": bulk - 2.0 * mu / 3.0},
        "mooney-rivlin": {"c10": 0.4 * mu, "c01": 0.1 * mu, "bulk": bulk},
        "ogden": {"mu": (2.0 * mu / 3.0,), "alpha": (3.0,), "bulk": bulk},
    }
    known = {
        "material": material,
        "law": label,
        "label": label,
        "status": "converged",
        "message": "",
        "density": None,
        "u": (11.5, 5.7) if label == "neo-hookean" else (11.5, 5.7, 0.2),
        "parameters": by_law[label],
        "shear_modulus": mu,
        "shear_modulus_sd": 700.0,
        "bulk_modulus": bulk,
        "estimates": (estimate(), estimate("bulk_ratio", value=300.0, seen="not identified")),
        "chi2": 90.0,
        "points": 100,
        "reduced_chi2": 90.0 / 98.0,
        "candidates": 60,
        "search_seconds": 3.0,
        "polish_seconds": 1.5,
    }
    return Calibration(**{**known, **more})


def failed(label: str = "neo-hookean", *, material: str = "A") -> Calibration:
    return Calibration(
        material=material,
        law=label,
        label=label,
        status="no equilibrium",
        message="nothing holds <there>",
        density=None,
    )


def estimate(name: str = "shear_modulus", *, value: float = 1e5, seen: str = "identified") -> Estimate:
    return Estimate(
        name=name,
        unit="Pa" if name.startswith("shear") else "-",
        value=value,
        sd=0.007,
        low=0.98 * value,
        high=1.02 * value,
        relative=True,
        seen=seen,  # type: ignore[arg-type]
    )
