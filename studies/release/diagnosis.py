"""The clamped Dragon Skin bar, diagnosed in parts: own weight alone, with 52 g alone, and all of it; prints
the tables of diagnosis.md and draws residuals.png.

    python -m studies.release.diagnosis     (2 to 3 core-minutes)

The measurements are real/clamped-beam-dragonskin10/experiment of the folder that TISIM_MEASURED names.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np

from calibration.diagnosis import Diagnosis, diagnose, model_of
from calibration.diagnosis.drawing.release import DrawnRelease, drawn
from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.lack_of_fit import LackOfFit
from calibration.errors import InputError
from calibration.experiment import BeamTrial, Experiment, read
from calibration.measurements.release.model import ReleaseModel
from studies.measured import ROOT, real

matplotlib.use("Agg")
import matplotlib.pyplot as plt

PICTURE = Path(__file__).with_name("residuals.png")
PARTS = {"own weight": ("gravity-a", "gravity-b"), "52 g hung": ("load52-a", "load52-b")}
SHOWN = 6  # explanations of a part


def part(experiment: Experiment, names: Sequence[str]) -> tuple[ReleaseModel, Diagnosis]:
    some = replace(experiment, trials=tuple(t for t in experiment.trials if t.id in names))
    model = model_of(some, kind="release", workers=1)
    assert isinstance(model, ReleaseModel)
    return model, diagnose(model)


def line(model: ReleaseModel, fit: Fit, left: LackOfFit) -> str:
    values = []
    for c in fit.candidates:
        effect = model.effects[c.effect]
        value, sd = (effect.in_file(x) for x in fit.amplitude(c))
        values.append(f"{c.label}: {value:.4g} ± {sd:.2g} {effect.parameter}")
    rms = 1e3 * model.distance_rms(fit.state)
    shear = ", ".join(f"{1e-3 * g:.1f}" for g in model.shear_moduli(fit.state.u).values())
    end = "" if fit.converged else " (not converged)"
    what = "; ".join(values) or "baseline"
    size = f"{fit.chi2:.0f} / {model.points}"
    return f"| {what}{end} | {size} | {rms:.3f} | {shear} | {left.p_value:.2g}, {left.worst} |"


def table(name: str, model: ReleaseModel, found: Diagnosis) -> None:
    finding = found.finding
    print(f"\n{name}: {finding.verdict}; {found.sentence()}")
    print("| explanation | chi2 / points | rms [mm] | G [kPa] | what is left: p, worst test |")
    print("| --- | --- | --- | --- | --- |")
    print(line(model, finding.baseline, finding.lack_of_fit))
    for e in finding.explanations[:SHOWN]:
        print(line(model, e.fit, e.lack_of_fit))
    if found.held_out is not None:
        g = found.held_out
        print(
            f"gain, {g.held_out or g.note}: {1e3 * g.rms_before:.3f} to {1e3 * g.rms_after:.3f} mm"
            f" (noise {1e3 * g.rms_noise:.3f})"
        )
    print(f"noise {1e3 * model.noise_rms():.3f} mm; {found.next_experiment}; {found.seconds:.0f} s")
    for r, fix in zip(model.records, model.corrections, strict=True):
        print(f"{r.name}: root {1e3 * fix.stiff_root:.2f} mm, inertia {100.0 * fix.extra_inertia:+.2f} %")
    base = finding.baseline.state
    print({n: round(float(v), 3) for n, v in zip(model.names, base.u, strict=True)})
    sys.stdout.flush()


def clamp_table(experiment: Experiment) -> None:
    """Motion of the markers next to the clamp per millimetre of the tip's free vibration, without a model."""
    print("\n| mm per mm of the tip's swing | base1 x, z | base2 x, z | base3 x, z | turn, of the drop |")
    print("| --- | --- | --- | --- | --- |")
    for t in experiment.trials:
        assert isinstance(t, BeamTrial)
        tip = np.mean([m.displacement[:, 2] for m in t.markers if m.name.startswith("tip")], axis=0)
        swings = np.flatnonzero(np.abs(tip - tip[0]) > 0.1 * abs(tip[-1]))[0] + np.arange(10, 110)
        slow = np.polynomial.polynomial.polyvander(swings / 100.0, 3)
        cells, rows = [], []
        for m in (m for m in t.markers if m.name.startswith("base")):
            basis = np.column_stack([tip[swings], slow])
            x, _, z = np.linalg.lstsq(basis, m.displacement[swings], rcond=None)[0][0]
            cells.append(f"{x:+.4f}, {z:+.4f}")
            rows.append((-m.position[2], x))
        height, along = np.array(rows).T
        turn = np.polyfit(height, along, 1)[0]  # [rad] a metre of the tip's way
        print(f"| {t.id} | {' | '.join(cells)} | {100.0 * turn * t.free_length:+.1f} % |")


def draw(bars: Sequence[DrawnRelease]) -> None:
    figure, axes = plt.subplots(1, len(bars), figsize=(3.0 * len(bars), 2.6), layout="constrained")
    for ax, d in zip(np.atleast_1d(axes), bars, strict=True):
        ax.axhline(0.0, color="k", lw=0.5)
        ax.semilogx(d.time, 1e3 * d.tip_before, "C0", lw=1, label="one relaxation time")
        if d.tip_after is not None:
            ax.semilogx(d.time, 1e3 * d.tip_after, "C1", lw=1, label="best explanation")
        ax.set_title(d.name, fontsize=9)
        ax.set_xlabel("time since release [s]", fontsize=8)
        ax.set_xticks([0.2, 0.5, 1.0, 2.0, 5.0], ["0.2", "0.5", "1", "2", "5"])
        ax.minorticks_off()
        ax.tick_params(labelsize=8)
    np.atleast_1d(axes)[0].set_ylabel("tip, measured - simulated [mm]", fontsize=8)
    np.atleast_1d(axes)[0].legend(fontsize=7)
    figure.savefig(PICTURE, dpi=68)


def main() -> None:
    experiment = read(real("clamped-beam-dragonskin10", "experiment"))
    clamp_table(experiment)
    bars: list[DrawnRelease] = []
    for name, trials in PARTS.items():
        model, found = part(experiment, trials)
        table(name, model, found)
        bars += drawn(model, found)
    draw(bars)
    model, found = part(experiment, [t.id for t in experiment.trials])
    table("all", model, found)
    print(f"\n{PICTURE.relative_to(ROOT)}")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    try:
        main()
    except InputError as error:
        print(error, file=sys.stderr)
        raise SystemExit(2) from None
