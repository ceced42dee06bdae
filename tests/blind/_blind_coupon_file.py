"""A made coupon experiment as a lab writes it down: noise and all, without the truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from _blind_coupon_case import Case
from _blind_coupon_curve import curve
from _blind_record_case import write_yaml


def write(case: Case, folder: Path, *, noise: float = 1.0) -> None:
    """experiment.yaml and its CSVs, without the truth. noise: part of the stated noise that is in them."""
    rng = np.random.default_rng([case.seed, 1])
    (folder / "coupons").mkdir(parents=True)
    trials: list[dict[str, Any]] = []
    for p in case.protocols:
        recorded, time, _ = p.path()
        # the lab reads the stretch with an error of its own: the stress is that of the true one
        stress = curve(p, case.hidden) + noise * p.stress_sd * rng.standard_normal(len(recorded))
        shown = recorded + noise * p.stretch_sd * rng.standard_normal(len(recorded))
        rows = ["stretch,nominal_stress_kPa,time_s"]
        rows += [f"{s:.7g},{1e-3 * q:.7g},{t:.7g}" for s, q, t in zip(shown, stress, time, strict=True)]
        (folder / "coupons" / f"{p.id}.csv").write_text("\n".join(rows) + "\n")
        trial: dict[str, Any] = {
            "id": p.id,
            "kind": "coupon",
            "material": p.material,
            "mode": p.mode,
            "record": f"coupons/{p.id}.csv",
            "stretch_sd": p.stretch_sd,
            "stress_sd_kPa": round(1e-3 * p.stress_sd, 9),
        }
        if p.specimen:
            trial["specimen"] = p.specimen
        trials.append(trial)
    write_yaml(folder, f"coupons {case.seed}", [p.material for p in case.protocols], trials)
