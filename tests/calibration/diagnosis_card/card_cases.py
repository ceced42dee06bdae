"""Diagnoses constructed without search and FEM, and beams photographed on a faulty rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from _folders import beam_entry, capture_entry, outline_columns, write_experiment
from scipy.interpolate import CubicSpline

import tisim
from calibration.diagnosis import Candidate, Diagnosis, Finding
from calibration.diagnosis.effects.outlines import EFFECTS
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.held_out import HeldOut
from calibration.diagnosis.engine.lack_of_fit import LackOfFit
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.screening import screen
from calibration.diagnosis.engine.verdict import Numbers, Subject
from calibration.experiment import Experiment, read
from calibration.measurements._state import Linearisation, State

MODULI = {"S0": 30e3, "S1": 10e3}


def bench(folder: Path) -> Experiment:
    """Cantilevers of 50 and 100 mm of S0 and S1, two specimens of S1; no test uses the outlines."""
    x = np.linspace(1.0, 45.0, 30)
    table = outline_columns(np.column_stack([x, 10.0 + 0 * x]), np.column_stack([x, -10.0 + 0 * x]))
    trials = [
        beam_entry(
            identifier,
            material=identifier[:2],
            specimen=specimen,
            free_length_mm=length,
            captures=[capture_entry(10.0 + length, "outline.csv")],
        )
        for identifier, specimen, length in (
            ("S0-50", "S0-a", 50.0),
            ("S1-50", "S1-a", 50.0),
            ("S1-100", "S1-b", 100.0),
        )
    ]
    return read(write_experiment(folder, trials, tables={"outline.csv": table}))


def diagnosis(
    causes: Mapping[Candidate, float], *, verdict: str = "found", rivals: Sequence[tuple[str, ...]] = ()
) -> Diagnosis:
    """Diagnosis of `bench` with these amplitudes [SI].

    The moduli are those of S0 and of the two specimens of S1; the geometric mean per material is MODULI. In
    the synthetic Jacobian the amplitudes are correlated with the moduli.
    """
    u = np.log([30e3, 10e3 * 1.1, 10e3 / 1.1])
    baseline = _fit(u + 0.1, {})
    explanations: tuple[Explanation, ...] = ()
    if causes:
        lack_of_fit = LackOfFit(p_value=0.5, each={}, worst="everything")
        explanations = (Explanation(fit=_fit(u, dict(causes)), cost=0.0, lack_of_fit=lack_of_fit),)
    finding = Finding(
        verdict=verdict,  # type: ignore[arg-type]
        baseline=baseline,
        lack_of_fit=LackOfFit(p_value=0.001, each={}, worst="everything"),
        p_value=0.001,
        screened=screen(baseline.linear, EFFECTS),
        null=Null(len(baseline.z), {}),
        explanations=explanations,
        equivalent=rivals or ((explanations[0].names,) if explanations else ()),
        confidence=0.9,
    )
    gain = HeldOut(
        held_out="leave-one-length-out",
        kept=0.6,
        rms_before=4e-4,
        rms_after=1e-4,
        rms_noise=1e-4,
        log_likelihood=20.0,
        folds=2,
    )
    before = {name: value * np.exp(0.1) for name, value in MODULI.items()}
    return Diagnosis(
        finding=finding,
        chosen=finding.chosen,
        effects=dict(EFFECTS),
        baseline=Numbers(reduced_chi2=2.5, p_value=1e-4, rms=0.3, shear_modulus_Pa=before),
        extended=Numbers(reduced_chi2=1.0, p_value=0.5, rms=0.1, shear_modulus_Pa=MODULI) if causes else None,
        held_out=gain if causes else None,
        subject=Subject(
            kind="outlines",
            unit=("mm", 1e3),
            modulus_weights={"S0": np.array([1.0, 0.0, 0.0]), "S1": np.array([0.0, 0.5, 0.5])},
            ranges={c: _range(c) for c in causes},
            materials={c: frozenset(_materials(c)) for c in causes},
        ),
        next_experiment="",
        undetectable=(),
        notes=(),
        seconds=1.0,
    )


# free length [mm], material and specimen of the beams of `bench`; the capture time [s] is 10 + length in mm
_BEAMS = ((50.0, "S0", "S0-a"), (50.0, "S1", "S1-a"), (100.0, "S1", "S1-b"))


def _reached(candidate: Candidate) -> list[tuple[float, str, str]]:
    return [b for b in _BEAMS if candidate.at in ("all", *b[1:])]


def _range(candidate: Candidate) -> dict[str, tuple[float, float]]:
    lengths = [b[0] for b in _reached(candidate)]
    return {
        "free_length_mm": (min(lengths), max(lengths)),
        "time_s": (10.0 + min(lengths), 10.0 + max(lengths)),
    }


def _materials(candidate: Candidate) -> list[str]:
    return [b[1] for b in _reached(candidate)]


def _fit(u: np.ndarray, causes: dict[Candidate, float]) -> Fit:
    random = np.random.default_rng(5)
    by_u = np.vstack([100.0 * np.eye(3), np.zeros((37, 3))])
    columns = random.standard_normal((40, len(causes))) + 30.0 * np.vstack(
        [np.ones((3, len(causes))), np.zeros((37, len(causes)))]
    )
    linear = Linearisation(
        state=State(u=u, amplitudes=causes),
        z=np.zeros(40),
        by_u=by_u,
        columns=columns,
        candidates=tuple(causes),
    )
    return Fit(linear=linear, converged=True)


def rig_file(path: Path, *effects: dict[str, Any], **more: Any) -> Path:
    """Write a rig.yaml with independent effects."""
    sds = [a["sd"] for e in effects for a in e["parameters"].values()]
    content = {
        "format": 1,
        "experiment": "made",
        "experiment_sha256": "0" * 64,
        "base_law": "neo-hookean",
        "use": "for tests",
        "effects": list(effects),
        "covariance": {"names": [e["effect"] for e in effects], "matrix": np.diag(np.square(sds)).tolist()},
        **more,
    }
    path.write_text(yaml.safe_dump(content))
    return path


def rig_effect(name: str, parameter: str, value: float, sd: float, **more: Any) -> dict[str, Any]:
    entry = {"effect": name, "belongs_to": "rig", "scope": "all"}
    return {**entry, "parameters": {parameter: {"value": value, "sd": sd}}, **more}


def faulty_beam(
    folder: Path, material: tisim.Material, *, tilt_deg: float = 0.0, depth_mm: float = 0.0
) -> Path:
    """Experiment with one photograph without noise of a 60 mm cantilever, simulated by tisim on another mesh.

    The clamp is tilted by `tilt_deg` and holds the beam only from `depth_mm` behind its face.
    """
    beam = tisim.Beam(
        material=material,
        length=(60.0 + depth_mm) / 1e3,
        axial_element_size=0.004,
        radial_elements=3,
        clamp_imperfections=tisim.ClampImperfections(tilt=np.radians(tilt_deg)),
    )
    (result,) = tisim.simulate([beam], workers=1)
    assert result.ok
    table = outline_columns(*(_edge(result, side, depth_mm) for side in (1.0, -1.0)))
    trial = beam_entry("S1-60", material="S1", free_length_mm=60.0, captures=[capture_entry(60.0, "60.csv")])
    belief = {"density_kg_m3": material.density, "density_sd_kg_m3": 5.0}
    return write_experiment(folder, [trial], tables={"60.csv": table}, materials={"S1": belief})


def _edge(result: tisim.Result, side: float, depth_mm: float) -> np.ndarray:
    """One edge [mm] at points 1.3 mm apart, x from the clamp's face."""
    rest, now = 1e3 * result.mesh.nodes, 1e3 * result.positions[-1]
    on = (np.abs(rest[:, 1]) < 1e-9) & (np.abs(rest[:, 2] - side * rest[:, 2].max()) < 1e-6)
    on &= (rest[:, 0] > -1e-9) & (rest[:, 0] < 1e3 * result.scene.length + 1e-9)  # type: ignore[union-attr]
    order = np.argsort(rest[on, 0])
    x, line = rest[on, 0][order][::2], now[on][order][::2][:, [0, 2]]
    at = np.arange(depth_mm + 1.0, x[-1] - 0.5, 1.3)
    return CubicSpline(x, line)(at) - np.array([depth_mm, 0.0])
