"""Diagnoses of clean coupons whose stress error is not stated: how many find something?

python -m studies.diagnosis.unstated_noise [--seeds 30] [--first 100]

Neo-Hookean curves with independent normal noise and nothing else, in seven designs. Also the degrees of
freedom of the standard deviation that a curve's scatter shows, beside its number of points.
"""

from __future__ import annotations

import argparse
import csv
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from scipy.stats import chi2

import calibration
from calibration.measurements.homogeneous import grows, unstated_sd

Array = NDArray[np.float64]

MODULUS, NOISE = 30.0, 0.6  # kPa
# nominal stress over shear modulus, and the first and last stretch (shear: amount + 1)
MODES: dict[str, tuple[Any, float, float]] = {
    "uniaxial": (lambda s: s - s**-2, 0.8, 1.6),
    "equibiaxial": (lambda s: s - s**-5, 1.0, 1.4),
    "planar": (lambda s: s - s**-3, 1.0, 1.6),
    "simple-shear": (lambda s: s - 1.0, 0.5, 1.5),
}
# specimens a mode, points a stroke, with the way back, modes
DESIGNS: dict[str, tuple[int, int, bool, int]] = {
    "tension, 2 specimens, 30 points": (2, 30, False, 1),
    "tension, 3 specimens, 15 points and back": (3, 15, True, 1),
    "tension, 3 specimens, 60 points and back": (3, 60, True, 1),
    "4 modes, 1 specimen each, 20 points": (1, 20, False, 4),
    "4 modes, 1 specimen each, 60 points": (1, 60, False, 4),
    "4 modes, 2 specimens each, 30 points and back": (2, 30, True, 4),
    "4 modes, 2 specimens each, 100 points and back": (2, 100, True, 4),
}


def write(folder: Path, design: tuple[int, int, bool, int], seed: int) -> None:
    """Write an experiment of coupons that states no stress error."""
    specimens, points, back, modes = design
    random = np.random.default_rng(seed)
    trials = []
    for mode in list(MODES)[:modes]:
        law, first, last = MODES[mode]
        for number in range(specimens):
            stretch = np.linspace(first, last, points)
            if back:
                stretch = np.concatenate([stretch, stretch[-2::-1]])
            stress = MODULUS * law(stretch) + NOISE * random.standard_normal(stretch.size)
            name = f"{mode}-{number}"
            with (folder / f"{name}.csv").open("w", newline="") as file:
                rows = csv.writer(file)
                rows.writerow(["stretch", "nominal_stress_kPa", "time_s"])
                rows.writerows(zip(stretch, stress, np.arange(stretch.size, dtype=float), strict=True))
            trials.append(
                {"id": name, "kind": "coupon", "material": "gel", "specimen": name, "mode": mode}
                | {"record": f"{name}.csv", "stretch_sd": 0.0}
            )
    gel = {"density_kg_m3": 1000.0, "density_sd_kg_m3": 5.0}
    content = {"format": 1, "name": "clean coupons", "materials": {"gel": gel}, "trials": trials}
    (folder / "experiment.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")


def freedom(points: int, *, curves: int = 1500) -> float:
    """Degrees of freedom nu of which 1 / s^2 has the upper hundredth of nu / chi2_nu."""
    random = np.random.default_rng(points)
    stretch = np.linspace(1.0, 1.6, points)
    clean = MODULUS * (stretch - stretch**-2)
    found = np.empty(curves)
    for k in range(curves):
        stress = clean + NOISE * random.standard_normal(points)
        found[k] = (
            np.median(unstated_sd(stretch, stress, stress, relative=grows([(stretch, stress)]))) / NOISE
        )
    far = np.quantile(found**-2.0, 0.99)
    tried = np.linspace(1.0, 200.0, 2000)
    return float(tried[np.argmin(np.abs(tried / chi2.ppf(0.01, tried) - far))])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--first", type=int, default=100)
    options = parser.parse_args()
    print("points of a curve, degrees of freedom of its scatter")
    for points in (20, 30, 60, 120, 300):
        print(f"  {points}: {freedom(points):.1f}")
    every: Counter[str] = Counter()
    for title, design in DESIGNS.items():
        verdicts: Counter[str] = Counter()
        for seed in range(options.first, options.first + options.seeds):
            with tempfile.TemporaryDirectory() as folder:
                write(Path(folder), design, seed)
                verdicts[str(calibration.diagnose(folder, workers=1, gain=False).verdict)] += 1
        every += verdicts
        print(f"{title}: {dict(verdicts)}", flush=True)
    print(f"together: {dict(every)}")


if __name__ == "__main__":
    main()
