"""Experiment folders for tests: written here in the file format, or the shared measured ones.

The writers follow the description of the format and share no code with calibration, which reads the folders.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

Entry = dict[str, Any]


def measured() -> Path:
    """Folder of measured experiments: $TISIM_MEASURED, else shared/measured in a parent of the repository.

    Skips the test if there is none.
    """
    named = os.environ.get("TISIM_MEASURED")
    if named:
        if not Path(named).is_dir():
            pytest.skip(f"TISIM_MEASURED={named} is no folder")
        return Path(named)
    repository = Path(__file__).resolve().parents[2]
    for folder in repository.parents:
        if (folder / "shared" / "measured").is_dir():
            return folder / "shared" / "measured"
    pytest.skip("no measured experiments: set TISIM_MEASURED, or put shared/measured beside the repository")


def write_csv(path: Path, columns: Mapping[str, Sequence[Any] | np.ndarray]) -> Path:
    """Write columns of equal length under a header line, floats at full precision."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = zip(*(list(values) for values in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(_cell(value) for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _cell(value: Any) -> str:
    return value if isinstance(value, str) else repr(float(value))


def write_experiment(
    folder: Path,
    trials: Sequence[Entry],
    *,
    tables: Mapping[str, Mapping[str, Sequence[Any] | np.ndarray]] | None = None,
    materials: Mapping[str, Entry] | None = None,
    name: str = "made",
    **more: Any,
) -> Path:
    """Write experiment.yaml and the tables (file name -> columns) that it names; return the folder.

    By default `materials` are those that the trials name, with density 1000 +- 5 kg/m3.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if materials is None:
        belief = {"density_kg_m3": 1000.0, "density_sd_kg_m3": 5.0}
        materials = {t["material"]: dict(belief) for t in trials if "material" in t}
    whole = {"format": 1, "name": name, "materials": dict(materials), "trials": list(trials), **more}
    text = yaml.safe_dump(whole, sort_keys=False, allow_unicode=True)
    (folder / "experiment.yaml").write_text(text, encoding="utf-8")
    for path, columns in (tables or {}).items():
        write_csv(folder / path, columns)
    return folder


def outline_columns(upper_mm: np.ndarray, lower_mm: np.ndarray) -> dict[str, Any]:
    """Table of an outline; each side is (k, 2) of x, z [mm]."""
    both = np.vstack([upper_mm, lower_mm])
    return {
        "side": ["upper"] * len(upper_mm) + ["lower"] * len(lower_mm),
        "x_mm": both[:, 0],
        "z_mm": both[:, 1],
    }


def marker_columns(time: np.ndarray, displacements_mm: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """Table of markers; each displacement is (t, 3) [mm] at the times (t,) [s]."""
    stacked = np.vstack(list(displacements_mm.values()))
    return {
        "marker": [name for name in displacements_mm for _ in time],
        "time_s": np.tile(time, len(displacements_mm)),
        **{f"u{axis}_mm": stacked[:, k] for k, axis in enumerate("xyz")},
    }


def capture_entry(time_s: float, outline: str, **more: Any) -> Entry:
    """Entry of a traced photograph."""
    return {
        "time_s": time_s,
        "outline": outline,
        "outline_sd_mm": 0.1,
        "outline_correlation_mm": 5.0,
        "registration_sd": {"shift_mm": 0.1, "roll_deg": 0.15, "scale": 0.003},
        **more,
    }


def beam_entry(identifier: str, *, material: str = "S0", **more: Any) -> Entry:
    """Entry of a round cantilever, 100 mm free, without captures and markers."""
    return {
        "id": identifier,
        "kind": "beam",
        "material": material,
        "section": {"circle": {"radius_mm": 10.0, "radius_sd_mm": 0.05}},
        "free_length_mm": 100.0,
        "free_length_sd_mm": 0.2,
        "grip_length_mm": 20.0,
        "supports": "clamped-free",
        "gravity_m_s2": [0.0, 0.0, -9.81],
        **more,
    }


def poke_entry(identifier: str, record: str, *, material: str = "S0", **more: Any) -> Entry:
    """Entry of a vertical indentation at the centre of a block."""
    return {
        "id": identifier,
        "kind": "poke",
        "material": material,
        "block_mm": [100.0, 100.0, 32.0],
        "rod": {"radius_mm": 2.5, "tip": "flat"},
        "start_mm": [0.0, 0.0, 32.0],
        "direction": [0.0, 0.0, -1.0],
        "record": record,
        "force_sd_N": 0.01,
        "depth_sd_mm": 0.02,
        **more,
    }


def coupon_entry(
    identifier: str, record: str, *, material: str = "S0", mode: str = "uniaxial", **more: Any
) -> Entry:
    """Entry of a homogeneous material test."""
    return {
        "id": identifier,
        "kind": "coupon",
        "material": material,
        "mode": mode,
        "record": record,
        "stretch_sd": 0.002,
        "stress_sd_kPa": 0.5,
        **more,
    }
