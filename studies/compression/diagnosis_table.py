"""What is wrong with the Ecoflex cylinders' simulation? Prints the tables of diagnosis.md.

    python -m studies.compression.diagnosis_table [FOLDER]        # a core-minute; also draws the picture

FOLDER holds experiment.yaml; by default silicone-compression of the measured data ($TISIM_MEASURED).
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np

from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.search import Finding, search
from calibration.experiment import Experiment, read
from calibration.measurements.compression import Cylinder
from calibration.measurements.compression._coordinates import MESH, MESH_BEND
from calibration.measurements.compression.model import CompressionModel
from studies.measured import real

PICTURE = Path(__file__).with_name("diagnosis-residuals.png")
CYLINDER = Cylinder(radius=0.025, height=0.030)
RANGES = (0.5, 0.3)
SHOWN = ("EF10-0T-A1", "EF30-0T-A3", "EF50-0T-A1")


def row(model: CompressionModel, e: Explanation) -> str:
    amplitudes = []
    for c in e.candidates:
        effect = model.effects[c.effect]
        value, sd = (effect.in_file(x) for x in e.fit.amplitude(c))
        end = ", at its bound" if e.fit.state.amplitudes[c] in effect.bounds else ""
        amplitudes.append(f"{c.label} {value:.3g} +- {abs(sd):.2g} {effect.parameter}{end}")
    shear = ", ".join(f"{1e-3 * g:.1f}" for g in model.shear_moduli(e.fit.state.u).values())
    worst = f"{e.lack_of_fit.worst}, {e.lack_of_fit.p_value:.2g}"
    return f"| {'; '.join(amplitudes)} | {e.fit.chi2:.0f} | {worst} | {shear} |"


def table(model: CompressionModel, title: str) -> Finding:
    finding = search(model)
    told = list(finding.explanations[:5])
    for count in (2, 1):  # the best of so many causes, where it is not among the first
        best = next((e for e in finding.explanations if len(e.names) == count), None)
        told += [best] if best is not None and best not in told else []
    shear = ", ".join(f"{1e-3 * g:.1f}" for g in model.shear_moduli(finding.baseline.state.u).values())
    print(f"\n{title}: {finding.verdict}; {model.points} points")
    print("\n| explanation | chi2 | what is left, chance by noise | G [kPa] |\n| --- | --- | --- | --- |")
    left = finding.lack_of_fit
    print(f"| baseline | {finding.baseline.chi2:.0f} | {left.worst}, {left.p:.2g} | {shear} |")
    for e in told:
        print(row(model, e))
    sys.stdout.flush()
    return finding


def deviations(model: CompressionModel, e: Explanation) -> None:
    """How far each record's own deviation is pulled, in what repeats differ by; and its misfit."""
    print("\n| record | pulls: zero, scale, bends 1 to 4 | chi2, of points |\n| --- | --- | --- |")
    first, terms = model.baseline.moduli, list(model.baseline.terms)
    for r, p in zip(model.records, model.stresses(e.fit.state), strict=True):
        pulls = e.fit.state.u[first : first + len(terms)] / model.wobble.sds[terms]
        first += len(terms)
        z = (p - r.stress) / r.sd
        print(f"| {r.name} | {', '.join(f'{x:.1f}' for x in pulls)} | {z @ z:.0f} of {r.points} |")
    mesh = np.abs(e.fit.state.u[-(MESH_BEND + 1) :] / MESH).max()
    print(f"\nlargest term of the mesh's error: {mesh:.1f} standard deviations")


def draw(model: CompressionModel, finding: Finding, best: Explanation) -> None:
    """What is left of three records along the strain, deviations of repeats not taken out."""
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(9.0, 3.4), layout="constrained", sharex=True, sharey=True)
    alone = next(e for e in finding.explanations if e.names == ("platen-bonding",))
    for axis, name in zip(axes, SHOWN, strict=True):
        k = next(k for k, r in enumerate(model.records) if r.name == name)
        r = model.records[k]
        axis.axhline(0.0, color="black", lw=0.8)
        for label, fit, colour in (
            ("free platens", finding.baseline, "tab:red"),
            ("bonded", alone.fit, "tab:blue"),
            (" + ".join(best.names), best.fit, "tab:green"),
        ):
            u = fit.state.u.copy()
            u[model.baseline.moduli : -(MESH_BEND + 1)] = 0.0
            p = model.stresses(replace(fit.state, u=u))[k]
            used = r.stretch < 0.98
            axis.plot(1 - r.stretch[used], 100 * (r.stress / p - 1)[used], color=colour, lw=1.4, label=label)
        axis.set_title(name, fontsize=9)
        axis.set_xlabel("strain")
        axis.set_ylim(-16, 14)
        axis.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("measured over simulated, less 1 / %")
    lines, labels = axes[0].get_legend_handles_labels()
    figure.legend(lines, labels, fontsize=8, frameon=False, loc="outside lower center", ncols=3)
    figure.savefig(PICTURE, dpi=90)


def only(data: Experiment, material: str) -> Experiment:
    kept = tuple(t for t in data.trials if t.material == material)
    return replace(data, trials=kept, materials={material: data.materials[material]})


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else real("silicone-compression", "experiment")
    data = read(folder)
    for last in RANGES:
        for title, part in (("all records", data), ("EF30 alone", only(data, "EF30"))):
            model = CompressionModel(part, cylinder=CYLINDER, last=last)
            finding = table(model, f"{title}, to a strain of {last:g}")
            deviations(model, finding.explanations[0])
            if part is data and last == RANGES[0]:
                draw(model, finding, finding.explanations[0])


if __name__ == "__main__":
    main()
