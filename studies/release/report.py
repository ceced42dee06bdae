"""The clamped Dragon Skin bar: fits gravity-a, predicts the other trials, prints the tables of README.md
and draws tip.png.

    python -m studies.release.report     (5 to 10 core-minutes)

The measurements are real/clamped-beam-dragonskin10/experiment of the folder that TISIM_MEASURED names.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment import BeamTrial, Experiment, read
from calibration.measurements.release import (
    Damping,
    Fidelity,
    MarkerObjective,
    Match,
    Nuisances,
    RingDown,
    marker_displacements,
    ringdown,
)
from calibration.parameters import parametrisation
from studies.measured import ROOT, real
from studies.release.fit import MotionFit, fit_motion
from tisim import Material, simulate
from tisim.mesh import beam_mesh

matplotlib.use("Agg")
import matplotlib.pyplot as plt

Array = NDArray[np.float64]
PICTURE = Path(__file__).with_name("tip.png")
FITTED, PREDICTED = "gravity-a", ("gravity-b", "load52-a", "load52-b")
TIP, BASE = ("tip1", "tip2", "tip3"), ("base1", "base2", "base3")
WINDOW, RINGING = 1.6, 1.5  # of the motion, from the first sample and from the release on [s]
GUESS = 100e3  # shear modulus that the first search starts from [Pa]
# what it swings about is not yet where it settles: left free by this much, or the damping makes up for it
CREEP = Nuisances(offset=1e-3)
NOTHING = Nuisances(position=0.0, frame=0.0)
FINE, SHORT = Fidelity(axial_element_size=0.010, radial_elements=2), Fidelity(time_step=1e-3)


@dataclass(frozen=True)
class Seen:
    """One trial, measured or predicted: mean of the tip markers [mm]."""

    drop: float
    ring: RingDown
    peak: float


def young(values: dict[str, float]) -> float:
    g, ratio = values["shear_modulus"], values["bulk_ratio"]
    return 9.0 * ratio * g / (3.0 * ratio + 1.0)


def objective(experiment: Experiment, name: str, **options: object) -> MarkerObjective:
    trial = next(t for t in experiment.trials if t.id == name)
    assert isinstance(trial, BeamTrial)
    settings: dict[str, object] = {"markers": TIP, "window": WINDOW, "workers": 1, **options}
    return MarkerObjective(trial, experiment.materials[trial.material], **settings)  # type: ignore[arg-type]


def fits(experiment: Experiment) -> dict[str, MotionFit]:
    """The fits of gravity-a: where it settles, and that with how it swings."""
    law = parametrisation("neo-hookean")
    settled = fit_motion(objective(experiment, FITTED, stages=("settled",)), law, shear=GUESS)
    start = settled.values["shear_modulus"]
    wanted = objective(experiment, FITTED, nuisances=CREEP)
    tip = wanted.markers[0]
    ring = ringdown(tip.time - wanted.bounds[0], tip.displacement[:, 2], last=RINGING)
    # all of the damping ratio to the stiffness at first
    guess = Damping(mass=0.1, stiffness=ring.damping_ratio / (np.pi * ring.frequency))
    both = fit_motion(wanted, law, shear=start, damping=guess)
    return {"settled pose": settled, "motion and settled pose (used below)": both}


def predict(experiment: Experiment, name: str, fit: MotionFit, fidelity: Fidelity | None = None) -> Match:
    """A trial with the fitted material; only the instant of release is taken from its data."""
    wanted = objective(experiment, name, markers=TIP + BASE, nuisances=NOTHING, fidelity=fidelity)
    match = wanted.matches([fit.material], [fit.damping])[0]
    if match is None:
        raise SystemExit(f"{name}: {wanted.failures[-1]}")
    return match


def seen(match: Match, displacement: tuple[Array, ...], settled: Array) -> Seen:
    z = 1e3 * np.mean([displacement[i][:, 2] for i in range(len(TIP))], axis=0)
    ring = ringdown(match.time[0] - match.release, z, last=RINGING)
    return Seen(float(-1e3 * settled[: len(TIP), 2].mean()), ring, float(-z.min()))


def fit_table(found: dict[str, MotionFit]) -> None:
    print("| fitted to | G [kPa] | E [kPa] | mass damping [1/s] | stiffness damping [ms] | chi2/n | runs |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, fit in found.items():
        g = fit.values["shear_modulus"]
        row = [f"{g / 1e3:.1f} ± {g * fit.sd['shear_modulus'] / 1e3:.1f}", f"{young(fit.values) / 1e3:.1f}"]
        for key, unit in (("mass_damping", 1.0), ("stiffness_damping", 1e3)):
            row.append(
                f"{fit.values[key] * unit:.2f} ± {fit.sd[key] * unit:.2f}" if key in fit.values else "-"
            )
        end = "" if fit.converged else f" (not converged: {fit.message})"
        print(f"| {name} | {' | '.join(row)} | {fit.chi_square / fit.points:.1f} | {fit.simulations}{end} |")


def trial_table(shown: dict[str, tuple[Seen, Seen]], stiffness: float) -> None:
    print("\n| measured / predicted | " + " | ".join(shown) + " |\n| --- |" + " --- |" * len(shown))
    rows = {
        "settled drop [mm]": lambda s: f"{s.drop:.2f}",
        "lowest point of the first swing [mm]": lambda s: f"{s.peak:.2f}",
        "frequency [Hz]": lambda s: f"{s.ring.frequency:.3f}",
        "damping ratio": lambda s: f"{s.ring.damping_ratio:.4f}",
        "centre of the swing after 1 s [mm]": lambda s: f"{-s.ring.centre:.2f}",
        "sinking of that centre [mm a decade of time]": lambda s: f"{-s.ring.creep:.2f}",
    }
    for label, text in rows.items():
        print(f"| {label} | " + " | ".join(f"{text(m)} / {text(p)}" for m, p in shown.values()) + " |")
    ratio = [stiffness * (m.ring.frequency / p.ring.frequency) ** 2 / 1e3 for m, p in shown.values()]
    print("| E that meets the frequency [kPa] | " + " | ".join(f"{e:.0f}" for e in ratio) + " |")


def base_table(matches: dict[str, Match]) -> None:
    """Base markers at their first sample (still held) and from there to rest."""
    print(
        "\n| base markers, size of u [mm] | " + " | ".join(matches) + " |\n| --- |" + " --- |" * len(matches)
    )
    for i, name in enumerate(BASE, start=len(TIP)):
        row = []
        for match in matches.values():
            held = match.measured[i][0]
            sizes = [
                np.linalg.norm(v) * 1e3
                for v in (held, match.settled_measured[i] - held, match.settled_predicted[i])
            ]
            row.append(f"{sizes[0]:.2f}, then {sizes[1]:.2f} / {sizes[2]:.2f}")
        print(f"| {name}: before the release, then by it / as predicted | " + " | ".join(row) + " |")


def settled_table(experiment: Experiment) -> None:
    """Each trial's own static fit: modulus, and the turn of the frame that its markers ask for."""
    print("\n| own fit of the settled pose | E [kPa] | frame turned about x, y, z [degrees] | chi2/n |")
    print("| --- | --- | --- | --- |")
    for name in (FITTED, *PREDICTED):
        wanted = objective(experiment, name, stages=("settled",))
        fit = fit_motion(wanted, parametrisation("neo-hookean"), shear=GUESS)
        match = wanted.matches([fit.material])[0]
        assert match is not None
        turns = [np.degrees(wanted.spread.frame) * match.nuisances[f"frame {a}"] for a in "xyz"]
        sd = fit.sd["shear_modulus"] * young(fit.values) / 1e3
        angles = ", ".join(f"{t:.1f}" for t in turns)
        left = fit.chi_square / fit.points
        print(f"| {name} | {young(fit.values) / 1e3:.1f} ± {sd:.1f} | {angles} | {left:.1f} |")


def error_table(experiment: Experiment, fit: MotionFit, base: Seen) -> None:
    """Errors by the mesh and the time step, on gravity-a."""
    fine = predict(experiment, FITTED, replace(fit), SHORT)
    short = seen(fine, fine.predicted, fine.settled_predicted)
    static = objective(experiment, FITTED, stages=("settled",), fidelity=FINE)
    (result,) = simulate(static.scenes(fit.material, fit.damping), workers=1)
    places = [m.position for m in static.markers]
    drop = -1e3 * marker_displacements(result, places)[:, -1, 2].mean()
    print(f"\nmesh: settled drop {base.drop:.3f} mm, {drop:.3f} mm with layers of 10 mm and 2 rings")
    for name in ("frequency", "damping_ratio"):
        a, b = getattr(base.ring, name), getattr(short.ring, name)
        print(f"time: {name} {a:.4f} with 2 ms steps, {b:.4f} with 1 ms")


def edge_line(experiment: Experiment, material: Material) -> None:
    """The 52 g hang on the top edge, not all over the face: the load on the face's top quarter instead."""
    wanted = objective(experiment, "load52-a", stages=("settled",), fidelity=FINE)
    (beam,) = wanted.scenes(material, Damping())
    mesh = beam_mesh(
        length=beam.length,
        section=beam.section,
        axial_element_size=beam.axial_element_size,
        radial_elements=beam.radial_elements,
    )
    face = mesh.facet_sets["tip"]
    height = mesh.nodes[face[:, :3], 2].mean(axis=1)
    top = replace(mesh, facet_sets={**mesh.facet_sets, "tip": face[height > 0.0075]})
    results = simulate([replace(beam, mesh=m) for m in (mesh, top)], workers=1)
    places = [m.position for m in wanted.markers]
    drops = [-1e3 * marker_displacements(r, places)[:, -1, 2].mean() for r in results]
    print(
        f"load52-a at the settled pose's modulus: drop {drops[0]:.2f} mm, {drops[1]:.2f} mm hung at the top"
    )


def draw(matches: dict[str, Match]) -> None:
    figure, axes = plt.subplots(2, len(matches), figsize=(16, 6), sharex=True, height_ratios=(2, 1))
    for k, (name, match) in enumerate(matches.items()):
        top, bottom = axes[0, k], axes[1, k]
        time = match.time[0] - match.release
        z = [
            1e3 * np.mean([u[i][:, 2] for i in range(len(TIP))], axis=0)
            for u in (match.measured, match.predicted)
        ]
        top.plot(time, z[0], "k", lw=1, label="measured")
        top.plot(time, z[1], "C1", lw=1, label="fitted" if name == FITTED else "predicted")
        top.axhline(1e3 * match.settled_measured[: len(TIP), 2].mean(), color="k", lw=0.5, ls=":")
        bottom.plot(time, z[0] - z[1], "C3", lw=0.8)
        bottom.axhline(0.0, color="k", lw=0.4)
        top.set_title(name)
        top.legend(loc="lower right")
        bottom.set_xlabel("time since release [s]")
    axes[0, 0].set_ylabel("tip markers, mean height [mm]")
    axes[1, 0].set_ylabel("measured - model [mm]")
    figure.tight_layout()
    figure.savefig(PICTURE, dpi=80)


def main() -> None:
    experiment = read(real("clamped-beam-dragonskin10", "experiment"))
    found = fits(experiment)
    fit_table(found)
    used = found["motion and settled pose (used below)"]
    sys.stdout.flush()
    matches = {name: predict(experiment, name, used) for name in (FITTED, *PREDICTED)}
    shown = {
        name: (seen(m, m.measured, m.settled_measured), seen(m, m.predicted, m.settled_predicted))
        for name, m in matches.items()
    }
    trial_table(shown, young(used.values))
    base_table(matches)
    settled_table(experiment)
    error_table(experiment, used, shown[FITTED][1])
    edge_line(experiment, found["settled pose"].material)
    draw(matches)
    print(f"\n{PICTURE.relative_to(ROOT)}")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    try:
        main()
    except InputError as error:
        print(error, file=sys.stderr)
        raise SystemExit(2) from None
