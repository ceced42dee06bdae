"""Make the example experiments of `datasets/measured`: one of each kind of measurement, with its truth.

    python -m benchmarks.blind.make_examples                                     # all: about a core-minute
    python -m benchmarks.blind.make_examples --only coupons --out examples

The five benches in `datasets/measured/bench` are older, made once by a solver that is not in this repository.
`truth.yaml` holds the hidden cause and the true parameters; no program reads it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from benchmarks.blind import compression, coupons, indentation
from benchmarks.blind.beams.model import Beam
from benchmarks.blind.beams.solver import solve
from benchmarks.blind.camera import Lens, Setting, Tube, View, photograph

OUT = Path(__file__).resolve().parents[2] / "datasets" / "measured"
RADIUS, DENSITY, SHEAR_MODULUS = 0.010, 1000.0, 30e3  # of the photographed beams [m], [kg/m3], [Pa]
# of the photographed beams: free length [mm], view of the camera
PHOTOGRAPHS = {
    60: View(target=(44.0, 0.0, 22.0), yaw=14.0, pitch=6.0, roll=1.0),
    100: View(target=(48.0, 0.0, 10.0), distance=460.0, yaw=20.0, pitch=9.0, roll=-2.0),
}
LENS = Lens(size=(1600, 1200), focal=3720.0, centre=(803.0, 594.0), k1=-0.1)
BOARD_CORNER = (12.0, 26.0)  # [mm]


def photographs(folder: Path) -> None:
    """Two silicone cantilevers in front of a checkerboard: the laboratory's equilibrium, ray-cast."""
    import cv2

    (folder / "photos").mkdir(parents=True)
    trials = []
    for length, view in PHOTOGRAPHS.items():
        shape = solve(
            Beam(length=1e-3 * length, bridge=False, mu=SHEAR_MODULUS, radius=RADIUS, density=DENSITY)
        )
        edges = 1e3 * shape.edges(np.linspace(0.0, 1.0, 400))
        # thickness of the bent beam: its own weight thins the long one by 0.6 % near the clamp
        half = 0.5 * np.linalg.norm(edges[0] - edges[1], axis=1)
        setting = Setting(
            tubes=(Tube(axis=edges.mean(axis=0), radius=half),),
            board_corner=BOARD_CORNER,
            seed=length,
        )
        name = f"photos/cantilever-{length:03d}.jpg"
        cv2.imwrite(str(folder / name), photograph(setting, LENS, view), [cv2.IMWRITE_JPEG_QUALITY, 88])
        trials.append(
            {
                "id": f"cantilever-{length:03d}",
                "kind": "beam",
                "material": "silicone",
                "section": {"circle": {"radius_mm": 1e3 * RADIUS, "radius_sd_mm": 0.05}},
                "free_length_mm": float(length),
                "free_length_sd_mm": 0.2,
                "grip_length_mm": 20.0,
                "supports": "clamped-free",
                "gravity_m_s2": [0.0, 0.0, -9.81],
                "captures": [
                    {
                        "time_s": 60.0,
                        "photo": name,
                        "photo_checkerboard": {"squares": [9, 6], "square_mm": 8.0},
                    }
                ],
            }
        )
    _describe(
        folder,
        {
            "format": 1,
            "name": "photographed cantilevers",
            "notes": "two silicone cylinders under their own weight, photographed before a checkerboard",
            "materials": {"silicone": {"density_kg_m3": DENSITY, "density_sd_kg_m3": 5.0}},
            "trials": trials,
        },
    )
    settings = {"board_corner_mm": list(BOARD_CORNER), "board_corner_sd_mm": 0.1}
    (folder / "photographs.yaml").write_text(yaml.safe_dump(settings, sort_keys=False), encoding="utf-8")
    _write_truth(folder, {"shear_modulus_Pa": {"silicone": SHEAR_MODULUS}, "effects": []})


def homogeneous(folder: Path) -> None:
    """Homogeneous material tests of two materials on a compliant machine."""
    case = coupons.make_coupon(11, "one", "machine-compliance", target=15.0)
    coupons.write(case, folder)
    _rename(folder, "homogeneous tests", "two materials in the same modes on one machine")
    _write_truth(folder, case.truth())


def indented(folder: Path) -> None:
    """Indentation of a thin layer, with an offset of the depth's zero."""
    case = indentation.make_poke(12, "one", "depth-offset", target=9.0)
    indentation.write(case, folder)
    _rename(
        folder,
        "indentation",
        "a rod pushed into a thin layer on a fixed base",
    )
    _write_truth(folder, case.truth())


def compressed(folder: Path) -> None:
    """Compression of cylinders of two materials whose ends are bonded to the platens."""
    compression.write(compression.draw("bonded", 0), folder)
    _rename(folder, "compression", "cylinders of 50 x 30 mm between platens, lubrication not stated")
    truth = {
        "shear_modulus_Pa": compression.SHEAR_MODULI,
        "effects": [{"effect": "platen-bonding", "amplitude": 1.0}],
    }
    _write_truth(folder, truth)


EXAMPLES: dict[str, Callable[[Path], None]] = {
    "photographs": photographs,
    "coupons": homogeneous,
    "indentation": indented,
    "compression": compressed,
}


def _rename(folder: Path, name: str, notes: str) -> None:
    found = yaml.safe_load((folder / "experiment.yaml").read_text(encoding="utf-8"))
    _describe(
        folder, {"format": 1, "name": name, "notes": notes, **{k: found[k] for k in ("materials", "trials")}}
    )


def _describe(folder: Path, content: dict[str, Any]) -> None:
    (folder / "experiment.yaml").write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")


def _write_truth(folder: Path, truth: dict[str, Any]) -> None:
    (folder / "truth.yaml").write_text(yaml.safe_dump(truth, sort_keys=False), encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--only", choices=list(EXAMPLES), action="append", help="only this (several times)")
    given = parser.parse_args()
    for name in given.only or EXAMPLES:
        folder = given.out / name
        if folder.exists():
            print(f"{folder}: expected no such folder; remove it to make the example anew", file=sys.stderr)
            return 2
        EXAMPLES[name](folder)
        print(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
