"""The made experiment that all is fitted to, and its truth, which is read for the percentages alone."""

from __future__ import annotations

import os
import time
from functools import cache
from pathlib import Path

import numpy as np
import yaml

from calibration.experiment import BeamTrial, read
from calibration.outlines import COARSE, REFERENCE, Fidelity, OutlineObjective

ROOT = Path(__file__).parent.parent.parent
BENCH = Path(os.environ.get("TISIM_MEASURED", ROOT.parent / "shared" / "measured")) / "bench" / "clean"
MIXTURES = ("S0", "S0.5", "S1")
RATIOS = (20.0, 100.0, 1000.0)  # K/G; the bench was made with 1000
BEGUN = time.process_time()


@cache
def truth() -> dict[str, float]:
    """The moduli that the bench was made with [Pa]."""
    text = (BENCH / "truth.yaml").read_text(encoding="utf-8")
    return {k: float(v) for k, v in yaml.safe_load(text)["shear_modulus_Pa"].items()}


def percent(mixture: str, shear: float) -> float:
    return 100.0 * (shear / truth()[mixture] - 1.0)


@cache
def objective(mixture: str) -> OutlineObjective:
    """The likelihood that calibration.fit uses, with its mesh correction."""
    data = read(BENCH)
    beams = [t for t in data.trials if isinstance(t, BeamTrial) and t.material == mixture]
    return OutlineObjective(beams, data.materials[mixture], fidelity=COARSE, reference=REFERENCE, workers=1)


def uncorrected(mixture: str, kind: type[OutlineObjective], fidelity: Fidelity) -> OutlineObjective:
    """The same photographs, another simulation, no mesh correction."""
    known = objective(mixture)
    return kind(known.trials, known.belief, fidelity=fidelity, reference=None, workers=1)


def signed(value: float) -> str:
    return f"{value:+.1f}" if np.isfinite(value) else "none"


def note(line: str) -> None:
    print(f"[{time.process_time() - BEGUN:5.0f} core-s] {line}", flush=True)
