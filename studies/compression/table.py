"""Ecoflex cylinders in compression: bonded or free platens, which fits? Prints the table of README.md.

    python -m studies.compression.table [FOLDER]        # five core-minutes; also draws the picture

FOLDER holds experiment.yaml; by default silicone-compression of the measured data ($TISIM_MEASURED).
"""

from __future__ import annotations

import os
import pickle
import sys
from pathlib import Path

import matplotlib
import numpy as np

import tisim
from calibration.errors import InputError
from calibration.experiment import CouponTrial, read
from calibration.measurements.compression import Cylinder, Platens, PressCurves, press_curves
from studies.compression.fit import PressFit, fit_press, repeats
from studies.measured import ROOT, real

PICTURE = Path(__file__).with_name("curves.png")
CYLINDER = Cylinder(radius=0.025, height=0.030)
RANGES = (0.30, 0.50)
SHOWN = ("EF10-0T-A1", "EF30-0T-A3", "EF50-0T-A1")


def all_curves(refinement: float) -> dict[tuple[str, str], PressCurves]:
    """Curves of all laws with both platens; laws that cannot be pressed are named and left out."""
    kept = os.environ.get("COMPRESSION_CURVES")  # a file to keep the curves in between runs
    if kept and Path(kept).exists():
        with Path(kept).open("rb") as file:
            return dict(pickle.load(file))
    found: dict[tuple[str, str], PressCurves] = {}
    kinds: tuple[Platens, ...] = ("bonded", "free")
    for platens in kinds:
        for law in tisim.laws.names():
            try:
                curves = press_curves(law, platens, CYLINDER, refinement=refinement)
            except ValueError as error:
                print(f"left out: {error}")
                continue
            found[law, platens] = curves
            short = f", {curves.runs_short} of {curves.runs} stop early" if curves.runs_short else ""
            print(f"{law}, {platens}: to strain {1 - curves.reached:.2f}{short}", flush=True)
    if kept:
        with Path(kept).open("wb") as file:
            pickle.dump(found, file)
    return found


def line(fit: PressFit) -> str:
    shape = [f"{n} {v:.2f}" for n, v in fit.values.items() if n not in ("shear_modulus", "bulk_ratio")]
    at = f" (at bound: {', '.join(fit.at_bound)})" if fit.at_bound else ""
    cells = (
        fit.trial,
        fit.platens,
        fit.law,
        f"{fit.values['shear_modulus'] * 1e-3:.1f}",
        f"{fit.values['bulk_ratio']:.0f}",
        (", ".join(shape) or "-") + at,
        f"{100 * fit.slack:.2f}",
        f"{100 * fit.error:.2f}",
        f"{fit.chi_square:.1f}",
    )
    return "| " + " | ".join(cells) + " |"


def check(curves: PressCurves, fit: PressFit, refinement: float) -> float:
    """Largest relative difference of the interpolated curve from a run at the fit's own parameters."""
    stretches = 1.0 - np.array([0.08, 0.17, 0.28, 0.42, 0.48])
    stretches = stretches[stretches >= 1.0 - fit.strains[1]]
    scene = tisim.Press(
        material=curves.material(fit.values),
        radius=CYLINDER.radius,
        height=CYLINDER.height,
        stretches=tuple(stretches),
        refinement=refinement,
    )
    (run,) = tisim.simulate([scene], workers=1)
    if not run.ok:
        return float("nan")
    assert run.nominal_stress is not None
    return float(np.abs(curves.stress(stretches, fit.values) / run.nominal_stress - 1.0).max())


def tension() -> None:
    """Neo-Hookean G of the same products in tension at a stretch of 1.5, from another laboratory."""
    shear = []
    for name in ("10", "30", "50"):
        # the file alone: the reader refuses the folder for another material's times
        path = real("silicone-tension", "experiment", "coupons", f"Ecoflex-00-{name}.csv")
        if not path.is_file():
            print(f"\nno tension data at {path}")
            return
        stretch, stress = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(0, 1)).T
        shear.append(f"00-{name} {float(np.interp(1.5, stretch, stress)) / (1.5 - 1.5**-2):.1f} kPa")
    print(f"\nG in tension, stretch 1.5: Ecoflex {', '.join(shear)}")


def draw(
    trials: dict[str, CouponTrial], fits: list[PressFit], curves: dict[tuple[str, str], PressCurves]
) -> None:
    """Stress of the fits over the measured one, over the longer range."""
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(12.0, 5.0), layout="constrained", sharex=True, sharey=True)
    for axis, name in zip(axes, SHOWN, strict=True):
        trial = trials[name]
        strain = np.linspace(0.05, RANGES[1], 80)
        measured = np.interp(strain, 1 - trial.stretch, trial.stress)
        axis.axhline(0.0, color="black", lw=1.5)
        for platens, colour in (("bonded", "tab:blue"), ("free", "tab:red")):
            for law, style in (("neo-hookean", "-"), ("mooney-rivlin", "--"), ("ogden", ":")):
                for fit in fits:
                    if (fit.trial, fit.law, fit.platens, fit.strains[1]) == (name, law, platens, RANGES[1]):
                        stress = curves[law, platens].stress(1 - strain + fit.slack, fit.values)
                        label = f"{platens}, {law}: {100 * fit.error:.1f} %"
                        error = 100 * (stress / measured - 1.0)
                        axis.plot(100 * strain, error, style, color=colour, label=label)
        axis.set(xlabel="engineering strain [%]", title=name, ylim=(-10.0, 15.0))
        axis.legend(fontsize=7, title="rms", title_fontsize=7, loc="upper left", ncols=1)
    axes[0].set_ylabel("fitted over measured stress, less 1 [%]")
    figure.savefig(PICTURE, dpi=110)


def main() -> None:
    """The table, the check of the interpolation, the picture."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else real("silicone-compression", "experiment")
    refinement = float(os.environ.get("COMPRESSION_REFINEMENT", "1.0"))
    try:
        trials = {t.id: t for t in read(folder).trials if isinstance(t, CouponTrial)}
    except InputError as error:
        sys.exit(str(error))
    curves = all_curves(refinement)
    again = [trial for name, trial in trials.items() if name.startswith("EF30")]
    fits: list[PressFit] = []
    for last in RANGES:
        noise = repeats(again, (0.05, last))
        print(f"\nstrain 5 to {100 * last:.0f} %; EF30 repeats: {100 * noise.relative_sd:.2f} %\n")
        print("| test | platens | law | G [kPa] | K/G | shape | slack [%] | rms [%] | chi2 a point |")
        print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
        for name in SHOWN:
            for (law, platens), family in curves.items():
                if family.reached > 1.0 - last + 1e-9:
                    print(f"| {name} | {platens} | {law} | no curve to this strain | | | | | |")
                    continue
                fits.append(fit_press(trials[name], family, last_strain=last, noise=noise))
                print(line(fits[-1]), flush=True)
    print("\ninterpolation against a run at the fitted parameters, EF30-0T-A3, bonded, largest difference:")
    for fit in fits:
        if (fit.trial, fit.platens, fit.strains[1]) == (SHOWN[1], "bonded", RANGES[1]):
            print(f"  {fit.law}: {100 * check(curves[fit.law, 'bonded'], fit, refinement):.2f} %", flush=True)
    tension()
    draw(trials, fits, curves)
    print(PICTURE.relative_to(ROOT))


if __name__ == "__main__":
    main()
