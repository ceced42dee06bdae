"""An experiment with every part of the format, as plain values that a test can change."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from _folders import (
    beam_entry,
    capture_entry,
    coupon_entry,
    marker_columns,
    outline_columns,
    poke_entry,
    write_experiment,
)

PNG = b"\x89PNG not looked into"


@dataclass
class Sample:
    """Trials in the order beam, poke, coupon; tables by file name; `raw`: other files."""

    trials: list[dict[str, Any]]
    tables: dict[str, dict[str, Any]]
    materials: dict[str, Any]
    raw: dict[str, bytes]
    more: dict[str, Any] = field(default_factory=dict)

    @property
    def beam(self) -> dict[str, Any]:
        return self.trials[0]

    @property
    def capture(self) -> dict[str, Any]:
        return self.trials[0]["captures"][0]

    @property
    def poke(self) -> dict[str, Any]:
        return self.trials[1]

    @property
    def coupon(self) -> dict[str, Any]:
        return self.trials[2]

    def write(self, folder: Path) -> Path:
        write_experiment(folder, self.trials, tables=self.tables, materials=self.materials, **self.more)
        for name, content in self.raw.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(content)
        return folder


def sample() -> Sample:
    x = np.linspace(2.0, 95.0, 12)
    sag = -0.002 * x**2
    up, down = np.column_stack([x, sag + 10]), np.column_stack([x, sag - 10])
    time = np.array([0.0, 0.1, 0.25])
    motion = np.outer(time, [1.0, 2.0, -30.0])
    beam = beam_entry(
        "bar",
        specimen="A",
        captures=[
            capture_entry(
                10.0,
                "beams/bar-t10.csv",
                photo="photos/bar.png",
                photo_checkerboard={"squares": [9, 6], "square_mm": 10.0},
            ),
            capture_entry(100.0, "beams/bar-t100.csv"),
        ],
        markers="beams/bar-markers.csv",
        marker_positions_mm={"tip1": [94.0, 0.0, 15.0], "base": [6.0, -25.0, -16.0]},
        marker_sd_mm=0.05,
    )
    poke = poke_entry(
        "poke",
        "pokes/poke.csv",
        inclusion={"sphere": {"radius_mm": 8.0, "centre_mm": [0.0, 0.0, 8.0]}},
        surfaces=[{"time_s": 2.0, "points": "pokes/scan.csv", "point_sd_mm": 0.1}],
    )
    coupon = coupon_entry("pull", "coupons/pull.csv")
    tables = {
        "beams/bar-t10.csv": outline_columns(up, down),
        "beams/bar-t100.csv": outline_columns(up * 0.99, down * 0.99),
        "beams/bar-markers.csv": marker_columns(time, {"tip1": motion, "base": 0.01 * motion}),
        "pokes/poke.csv": {
            "time_s": [0.0, 1.0, 2.0, 3.0],
            "depth_mm": [0.0, 2.0, 2.0, 1.0],
            "force_N": [0.0, 0.5, 0.45, 0.1],
            "force_x_N": [0.0, 0.01, 0.0, 0.0],
            "force_y_N": [0.0, 0.0, 0.02, 0.0],
            "force_z_N": [0.0, 0.5, 0.45, 0.1],
        },
        "pokes/scan.csv": {"x_mm": [0, 1, 2], "y_mm": [3, 4, 5], "z_mm": [30, 31, 32]},
        "coupons/pull.csv": {
            "stretch": [1.0, 1.1, 1.2],
            "nominal_stress_kPa": [0.0, 3.0, 5.5],
            "time_s": [0.0, 1.0, 2.0],
        },
    }
    materials = {"S0": {"softener_ratio": 0.5, "density_kg_m3": 1000.0, "density_sd_kg_m3": 5.0}}
    return Sample([beam, poke, coupon], tables, materials, {"photos/bar.png": PNG})
