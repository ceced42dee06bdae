"""An experiment of unloaded beams, whose errors are known for any material, and files of fits.

An unloaded beam stays straight; its outline displaced by d is that of the cylinder displaced by d.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from _folders import beam_entry, capture_entry, outline_columns, write_experiment

RADIUS_MM, LENGTH_MM = 10.0, 50.0


def displaced(folder: Path, shifts_mm: dict[str, tuple[float, ...]], *, gravity: float = 0.0) -> Path:
    """Write one 50 mm beam per mixture, a capture for each shift [mm]; "S0.5" has the softener ratio 0.5."""
    trials, tables, materials = [], {}, {}
    x = np.linspace(0.5, LENGTH_MM, 40)
    for mixture, shifts in shifts_mm.items():
        captures = []
        for k, d in enumerate(shifts):
            path = f"beams/{mixture}-{k}.csv"
            upper, lower = (np.column_stack([x, np.full_like(x, d + s)]) for s in (RADIUS_MM, -RADIUS_MM))
            tables[path] = outline_columns(upper, lower)
            captures.append(capture_entry(10.0 * (k + 1), path))
        trials.append(
            beam_entry(
                f"{mixture}-short",
                material=mixture,
                free_length_mm=LENGTH_MM,
                gravity_m_s2=[0.0, 0.0, gravity],
                captures=captures,
            )
        )
        materials[mixture] = {
            "softener_ratio": float(mixture[1:]),
            "density_kg_m3": 1000.0,
            "density_sd_kg_m3": 5.0,
        }
    return write_experiment(folder, trials, tables=tables, materials=materials)


def on_a_faulty_rig(
    folder: Path, *, tilt_deg: float, depth_mm: float, scale: float, supports: str = "clamped-free"
) -> Path:
    """Write one unloaded 50 mm beam of S0, held `depth_mm` behind the face of a clamp that is tilted.

    The photograph enlarges it by `scale` about the face.
    """
    turn = np.radians(tilt_deg)
    along = np.linspace(depth_mm + 0.5, depth_mm + LENGTH_MM, 40)
    edges = []
    for side in (RADIUS_MM, -RADIUS_MM):
        x = along * np.cos(turn) - side * np.sin(turn) - depth_mm
        z = along * np.sin(turn) + side * np.cos(turn)
        edges.append((1.0 + scale) * np.column_stack([x, z])[x > 0.3])
    trial = beam_entry(
        "S0-short",
        material="S0",
        free_length_mm=LENGTH_MM,
        supports=supports,
        gravity_m_s2=[0.0, 0.0, 0.0],
        captures=[capture_entry(10.0, "beams/S0.csv")],
    )
    belief = {"softener_ratio": 0.0, "density_kg_m3": 1000.0, "density_sd_kg_m3": 5.0}
    return write_experiment(
        folder, [trial], tables={"beams/S0.csv": outline_columns(*edges)}, materials={"S0": belief}
    )


def rig_file(path: Path, **parameters: tuple[str, str, float]) -> Path:
    """Write a rig.yaml; `parameters` : effect, with underscores, to whom it belongs, parameter and value."""
    effects = [
        {
            "effect": name.replace("_", "-"),
            "belongs_to": whose,
            "scope": "all",
            "parameters": {parameter: {"value": value, "sd": 0.01}},
        }
        for name, (whose, parameter, value) in parameters.items()
    ]
    content = {
        "format": 1,
        "experiment": "made",
        "experiment_sha256": "0" * 64,
        "base_law": "neo-hookean",
        "use": "for tests",
        "effects": effects,
        "covariance": {
            "names": list(parameters),
            "matrix": (1e-4 * np.eye(len(effects))).tolist(),
        },
    }
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path


def fit_file(
    folder: Path,
    *,
    digest: str,
    material: str,
    law: str,
    parameters: dict[str, Any],
    header: dict[str, Any] | None = None,
    **more: Any,
) -> Path:
    """Write MATERIAL-LAW.json as a study writes it; `more` replaces values of the calibration."""
    calibration = {
        "material": material,
        "law": law,
        "label": law,
        "status": "converged",
        "message": "",
        "density": 1000.0,
        "u": [10.0, 5.0],
        "parameters": parameters,
        "shear_modulus": 20e3,
        "shear_modulus_sd": 100.0,
        "bulk_modulus": 6e6,
        "estimates": [],
        "blind": [],
        "chi2": 100.0,
        "points": 100,
        "reduced_chi2": 1.0,
        "rms": 1e-4,
        "nuisances": {},
        "held_out": [],
        "held_out_note": "",
        "candidates": 50,
        "generations": 10,
        "without_answer": 0,
        "search_reason": "converged: tolfun",
        "search_seconds": 5.0,
        "polish_seconds": 2.0,
        "wall_seconds": 9.0,
        **more,
    }
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{material}-{law}.json"
    known = {"format": 1, "data": digest, "material": material, "law": law, **(header or {})}
    path.write_text(json.dumps({"header": known, "calibration": calibration}), encoding="utf-8")
    return path
