"""Homogeneous tests over time by the blind laboratory, which shares no code with calibration or tisim."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
import yaml

from benchmarks.blind.timed.coupons import Response, respond
from benchmarks.blind.timed.course import Course
from benchmarks.blind.timed.material import Prony, Softening, Solid
from calibration.experiment.model import CouponMode, CouponTrial

SOLID = Solid(
    mu=(2e4,),
    alpha=(3.0,),
    prony=Prony(fractions=(0.3, 0.2), times=(2.0, 60.0)),
    softening=Softening(r=1.8, m=1500.0, beta=0.15),
)
# of `SOLID`, by the names of a fit's parameters
TRUTH = {
    "shear_modulus": SOLID.shear_modulus,
    "alpha": 3.0,
    "prony_fraction_1": 0.3,
    "prony_time_1": 2.0,
    "prony_fraction_2": 0.2,
    "prony_time_2": 60.0,
    "mullins_r": 1.8,
    "mullins_m": 1500.0,
    "mullins_beta": 0.15,
}
REST = Course(start=1.0, samples=30)
RELAXATION = REST.ramp(1.5, 0.5).hold(300.0).ramp(1.02, 0.1).hold(100.0)
CYCLES = REST.ramp(1.3, 0.05).ramp(1.02, 0.05).ramp(1.7, 0.05).ramp(1.02, 0.05)


@lru_cache
def _response(solid: Solid, mode: str, course: Course) -> Response:
    return respond(solid, mode, course, tolerance=1e-5)


def trial(
    name: str,
    mode: CouponMode,
    course: Course,
    *,
    solid: Solid = SOLID,
    noise: float = 0.0,
    seed: int = 0,
    specimen: str | None = None,
) -> CouponTrial:
    """Synthetic trial; `noise` is the standard deviation as a fraction of the largest stress."""
    made = _response(solid, mode, course)
    sd = (noise or 0.005) * float(np.abs(made.stress).max())
    error = noise / (noise or 1.0) * sd * np.random.default_rng(seed).standard_normal(made.stress.size)
    return CouponTrial(
        id=name,
        material="M",
        mode=mode,
        stretch=made.stretch,
        stress=made.stress + error,
        time=made.time,
        stress_sd=sd,
        specimen=specimen,
    )


def write(folder: Path, trials: list[CouponTrial], *, clock: bool = True) -> Path:
    """Write the trials as an experiment; return its folder."""
    folder.mkdir(parents=True, exist_ok=True)
    entries = []
    for t in trials:
        assert t.time is not None
        assert t.stress_sd is not None
        lines = ["stretch,nominal_stress_kPa" + (",time_s" if clock else "")]
        for s, p, at in zip(t.stretch, t.stress, t.time, strict=True):
            lines.append(f"{s:.8g},{p / 1e3:.8g}" + (f",{at:.8g}" if clock else ""))
        (folder / f"{t.id}.csv").write_text("\n".join(lines) + "\n")
        entries.append(
            {
                "id": t.id,
                "kind": "coupon",
                "material": t.material,
                "mode": t.mode,
                "record": f"{t.id}.csv",
                "stress_sd_kPa": t.stress_sd / 1e3,
            }
        )
    content = {"format": 1, "name": "made", "materials": {"M": {}}, "trials": entries}
    (folder / "experiment.yaml").write_text(yaml.safe_dump(content))
    return folder
