"""What is wrong with the Ecoflex cylinders' simulation? Prints the tables of diagnosis.md.

    python -m studies.compression.diagnosis_table [FOLDER]        # 15 core-seconds; also draws the picture

FOLDER holds experiment.yaml; by default silicone-compression of the measured data ($TISIM_MEASURED). Verdicts
are those of `python -m calibration.diagnose`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.catalogue import effects_of
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.lack_of_fit import LackOfFit
from calibration.diagnosis.engine.run import Diagnosis
from calibration.diagnosis.laws import diagnose_with_law
from calibration.experiment import Experiment, read
from calibration.measurements.compression import Cylinder
from calibration.measurements.compression._coordinates import MESH
from calibration.measurements.compression._repeatability import FIRST, TERMS
from calibration.measurements.compression.model import CompressionModel
from studies.measured import real

Array = NDArray[np.float64]

PICTURE = Path(__file__).with_name("diagnosis-residuals.png")
CYLINDER = Cylinder(radius=0.025, height=0.030)
RANGES = (0.5, 0.3)
SHOWN = ("EF10-0T-A1", "EF30-0T-A3", "EF50-0T-A1")
TOLD = 5  # explanations of a table, and the best one of each number of causes


def diagnosed(data: Experiment, last: float) -> tuple[Diagnosis, CompressionModel]:
    """Diagnosis of the records up to a strain, as by the command."""

    def make(*, further: bool = True) -> CompressionModel:
        effects = {n: e for n, e in effects_of("compression").items() if further or not e.further}
        return CompressionModel(data, effects=effects, cylinder=CYLINDER, last=last)  # type: ignore[arg-type]

    found, model = diagnose_with_law(make)
    assert isinstance(model, CompressionModel)
    return found, model


def table(found: Diagnosis, model: CompressionModel, title: str) -> Iterator[str]:
    """Lines of the explanations, best first."""
    finding = found.finding
    yield f"\n{title}: {finding.verdict}; {model.points} points"
    yield f"{found.sentence()}\nNext: {found.next_experiment}"
    yield "\n| explanation | chi2 | what is left, chance by noise | G [kPa] |\n| --- | --- | --- | --- |"
    yield _line("baseline", finding.baseline, finding.lack_of_fit, model)
    for e in _told(finding.explanations):
        yield _line("; ".join(_amplitudes(model, e)), e.fit, e.lack_of_fit, model)


def _told(explanations: tuple[Explanation, ...]) -> list[Explanation]:
    told = list(explanations[:TOLD])
    for count in (2, 1):
        best = next((e for e in explanations if len(e.names) == count), None)
        told += [best] if best is not None and best not in told else []
    return told


def _line(label: str, fit: Fit, left: LackOfFit, model: CompressionModel) -> str:
    shear = ", ".join(f"{1e-3 * g:.1f}" for g in model.shear_moduli(fit.state.u).values())
    return f"| {label} | {fit.chi2:.0f} | {left.worst}, {left.p_value:.2g} | {shear} |"


def _amplitudes(model: CompressionModel, e: Explanation) -> Iterator[str]:
    for c in e.candidates:
        effect = model.effects[c.effect]
        value, sd = (effect.in_file(x) for x in e.fit.amplitude(c))
        end = ", at its bound" if e.fit.state.amplitudes[c] in effect.bounds else ""
        yield f"{c.label} {value:.3g} +- {abs(sd):.2g} {effect.parameter}{end}"


def deviations(model: CompressionModel, e: Explanation) -> Iterator[str]:
    """How far each record's own deviation is pulled, in what repeats differ by; and its misfit."""
    own, terms = model.coordinates, list(model.coordinates.terms)
    yield f"\n| record | pulls: {', '.join(TERMS[t] for t in terms)} | chi2, of points |\n| --- | --- | --- |"
    first = model.baseline.first_extra
    for r, p in zip(model.records, model.stresses(e.fit.state), strict=True):
        pulls = e.fit.state.u[first : first + len(terms)] / model.repeatability.sds[terms]
        first += len(terms)
        z = (p - r.stress) / r.sd
        yield f"| {r.name} | {', '.join(f'{x:.1f}' for x in pulls)} | {z @ z:.0f} of {r.points} |"
    mesh = np.abs(own.mesh(e.fit.state.u) / MESH).max()
    yield f"\nlargest term of the mesh's error: {mesh:.1f} standard deviations"


def left_over(model: CompressionModel, fit: Fit) -> dict[str, tuple[Array, Array]]:
    """Strain, and measured over simulated stress less 1, of each record from a strain of FIRST on; deviations
    of repeats are not taken out."""
    u = fit.state.u.copy()
    u[model.baseline.first_extra : u.size - model.coordinates.mesh(u).size] = 0.0
    found = {}
    for r, p in zip(model.records, model.stresses(replace(fit.state, u=u)), strict=True):
        used = 1.0 - r.stretch > FIRST
        found[r.name] = 1.0 - r.stretch[used], r.stress[used] / p[used] - 1.0
    return found


def draw(found: Diagnosis, model: CompressionModel) -> None:
    """Residuals of three records along the strain."""
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(9.0, 3.4), layout="constrained", sharex=True, sharey=True)
    explanations = found.finding.explanations
    alone = next(e for e in explanations if e.names == ("platen-bonding",))
    best = explanations[0]
    lines = (
        ("free platens", found.finding.baseline, "tab:red"),
        ("bonded", alone.fit, "tab:blue"),
        (" + ".join(best.names), best.fit, "tab:green"),
    )
    for label, fit, colour in lines:
        left = left_over(model, fit)
        for axis, name in zip(axes, SHOWN, strict=True):
            strain, own = left[name]
            axis.plot(strain, 100 * own, color=colour, lw=1.4, label=label)
    for axis, name in zip(axes, SHOWN, strict=True):
        axis.axhline(0.0, color="black", lw=0.8, zorder=0)
        axis.set_title(name, fontsize=9)
        axis.set_xlabel("strain")
        axis.set_ylim(-16, 14)
        axis.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("measured over simulated, less 1 / %")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, fontsize=8, frameon=False, loc="outside lower center", ncols=3)
    figure.savefig(PICTURE, dpi=90)


def only(data: Experiment, material: str) -> Experiment:
    kept = tuple(t for t in data.trials if t.material == material)
    return replace(data, trials=kept, materials={material: data.materials[material]})


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else real("silicone-compression", "experiment")
    data = read(folder)
    for last in RANGES:
        for title, part in (("all records", data), ("EF30 alone", only(data, "EF30"))):
            found, model = diagnosed(part, last)
            print("\n".join(table(found, model, f"{title}, to a strain of {last:g}")))
            print("\n".join(deviations(model, found.finding.explanations[0])), flush=True)
            if part is data and last == RANGES[0]:
                draw(found, model)


if __name__ == "__main__":
    main()
