"""The tables and pictures of README.md:  python -m studies.coupons.table [PART ...]

Without a PART all are made (some four minutes of one core). Tables go into README.md between their
markers, pictures beside it. The measured data are in real/ of the folder that TISIM_MEASURED names.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt

from calibration.experiment import CouponMode, CouponTrial, read
from calibration.measurements.homogeneous import nominal_stress, nominal_stresses, percent_error
from calibration.parameters import parametrisation
from studies.coupons.fit import CouponFit, FitStatus, fit_coupons
from studies.measured import ROOT, real
from studies.pages import insert

PAGE = Path(__file__).with_name("README.md")
RUBBERS = {"Meunier": "meunier-2008-silicone", "Treloar": "treloar-1944", "Kawabata": "kawabata-1981"}
LAWS = (
    ("st-venant-kirchhoff", 1),
    ("neo-hookean", 1),
    ("stable-neo-hookean", 1),
    ("mooney-rivlin", 1),
    ("arruda-boyce", 1),
    ("ogden", 1),
    ("ogden", 2),
    ("ogden", 3),
)
MODES: tuple[CouponMode, ...] = ("uniaxial", "equibiaxial", "planar")
# Nobody measured it here; 1 to 2 GPa over 0.4 MPa is a rubber's.
HELD = {"bulk_ratio": 3000.0}
SEED = 0
MANY_BASINS = 2000  # evaluations of CMA-ES for two and three Ogden terms


def trials(folder: str) -> list[CouponTrial]:
    """The coupons of one experiment, in the order of MODES; points at rest say nothing and stay."""
    found = [t for t in read(real(folder)).trials if isinstance(t, CouponTrial)]
    return sorted(found, key=lambda t: MODES.index(t.mode))


def pulled_silicones() -> list[CouponTrial]:
    """As `trials`, for tables whose time runs backwards at two places in the source: `read` refuses those,
    rightly, and nothing here uses time."""
    found = []
    for path in sorted(real("silicone-tension", "experiment", "coupons").glob("*.csv")):
        columns = np.genfromtxt(path, delimiter=",", names=True)
        found.append(
            CouponTrial(
                id=path.stem,
                material=path.stem,
                mode="uniaxial",
                stretch=columns["stretch"],
                stress=1e3 * columns["nominal_stress_kPa"],
            )
        )
    return found


def rubber(name: str) -> list[CouponTrial]:
    return trials(f"rubber-multiaxial/{RUBBERS[name]}")


def fit(coupons: Sequence[CouponTrial], law: str, terms: int, *, quick: bool = False) -> CouponFit:
    basins = 0 if terms == 1 else 500 if quick else MANY_BASINS
    starts = 3 if quick else 6
    return fit_coupons(
        parametrisation(law, terms=terms), coupons, starts=starts, evolution=basins, seed=SEED, held=HELD
    )


@cache
def on_all(name: str, law: str, terms: int) -> CouponFit:
    return fit(rubber(name), law, terms)


def cells(found: CouponFit, coupons: Iterable[CouponTrial], fitted: str | None = None) -> list[str]:
    """Errors of each curve in percent; the fitted mode's in bold."""
    if found.status is FitStatus.NO_ANSWER:
        return ["none" for _ in coupons]
    marks = []
    for trial in coupons:
        error = percent_error(trial, found.material())
        text = "none" if np.isnan(error) else f"{error:.1f}" if error < 100 else f"{error:.0f}"
        text += "*" if found.status is not FitStatus.CONVERGED else ""
        marks.append(f"**{text}**" if trial.mode == fitted else text)
    return marks


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def all_modes() -> str:
    """Every law on the three curves of a rubber at once, by the objective's own weights."""
    head = ["law", *(f"{name} {mode[:2]}" for name in RUBBERS for mode in MODES), "starts at the best"]
    rows = []
    for law, terms in LAWS:
        fits = [on_all(name, law, terms) for name in RUBBERS]
        errors = [cell for name, f in zip(RUBBERS, fits, strict=True) for cell in cells(f, rubber(name))]
        rows.append(
            [fits[0].parametrisation.label, *errors, ", ".join(f"{f.reached}/{f.starts}" for f in fits)]
        )
    return table(head, rows)


def equal_weights() -> str:
    """Meunier once more, each point with the same error in kPa: comparable with published fits."""
    rows = []
    for law, terms in LAWS:
        coupons = [replace(t, stress_sd=10e3) for t in rubber("Meunier")]
        found = fit(coupons, law, terms)
        rows.append([found.parametrisation.label, *cells(found, coupons), f"{found.reached}/{found.starts}"])
    return table(["law", *MODES, "starts at the best"], rows)


def one_mode() -> str:
    """Fitted on one curve (bold), predicting the other two."""
    parts = []
    for name in RUBBERS:
        rows = []
        for law, terms in LAWS:
            row = [parametrisation(law, terms=terms).label]
            for trial in rubber(name):
                found = fit([trial], law, terms, quick=True)
                row += cells(found, rubber(name), trial.mode)
            rows.append(row)
        head = ["law", *(f"{on[:2]}: {mode[:2]}" for on in MODES for mode in MODES)]
        parts.append(f"{name} (fitted on: error of)\n\n{table(head, rows)}")
    return "\n\n".join(parts)


def parameters() -> str:
    """Parameters by the fits of `all_modes`, with what determines them."""
    rows = []
    for name in RUBBERS:
        for law, terms in LAWS:
            found = on_all(name, law, terms)
            if found.identification is None:
                continue
            values = []
            for e in found.identification.estimates:
                if e.name in found.held:
                    continue
                scale, unit = (1e-3, " kPa") if e.unit == "Pa" else (1.0, "")
                note = f" ({found.undecided[e.name]})" if e.name in found.undecided else ""
                low, high = e.low * scale, e.high * scale
                values.append(f"{e.name} {e.value * scale:.3g} [{low:.3g}, {high:.3g}]{unit}{note}")
            rows.append(
                [
                    name,
                    found.parametrisation.label,
                    "; ".join(values),
                    f"{np.sqrt(found.identification.scale):.1f}",
                ]
            )
    return table(["rubber", "law", "value [95 % interval]", "misfit / noise"], rows)


def silicones() -> str:
    """19 silicones in tension: up to stretch 2, and to failure."""
    # of one curve three Ogden terms make no more than two, and both Neo-Hookean laws the same
    chosen = [(law, terms) for law, terms in LAWS if law != "stable-neo-hookean" and terms < 3]
    labels = [parametrisation(law, terms=terms).label for law, terms in chosen]
    rows = []
    for trial in pulled_silicones():
        row = [trial.id, f"{trial.stretch.max():.1f}"]
        for last in (2.0, np.inf):
            kept = trial.stretch <= last
            part = replace(trial, stretch=trial.stretch[kept], stress=trial.stress[kept], time=None)
            thin = np.unique(np.linspace(0, part.stretch.size - 1, 50).astype(int))
            thinned = replace(part, stretch=part.stretch[thin], stress=part.stress[thin])
            for law, terms in chosen:
                row += cells(fit([thinned], law, terms, quick=True), [part])
        rows.append(row)
        print(" | ".join(row), flush=True)
    middle = ["median", ""]
    for column in range(2, len(rows[0])):
        numbers = [float(r[column].rstrip("*")) for r in rows if r[column] != "none"]
        middle.append(f"{np.median(numbers):.1f}" if numbers else "none")
    head = ["silicone", "fails at", *(f"{n} to 2" for n in labels), *(f"{n} to failure" for n in labels)]
    return table(head, [*rows, middle])


def pictures() -> None:
    """Points and curves of the fits of `all_modes`."""
    shown = (("neo-hookean", 1), ("mooney-rivlin", 1), ("arruda-boyce", 1), ("ogden", 1), ("ogden", 3))
    for name in RUBBERS:
        figure, axes = plt.subplots(1, 3, figsize=(12, 4), layout="constrained")
        for axis, trial in zip(axes, rubber(name), strict=True):
            s = np.linspace(trial.stretch.min(), trial.stretch.max(), 200)
            for law, terms in shown:
                found = on_all(name, law, terms)
                stress = nominal_stress(found.material(), trial.mode, s)
                axis.plot(s, stress * 1e-3, label=found.parametrisation.label, linewidth=1.3)
            axis.plot(trial.stretch, trial.stress * 1e-3, "ko", markersize=3.5, label="measured")
            span = np.ptp(trial.stress) * 1e-3
            axis.set_ylim(trial.stress.min() * 1e-3 - 0.1 * span, trial.stress.max() * 1e-3 + 0.1 * span)
            axis.set(title=f"{name}, {trial.mode}", xlabel="stretch")
        axes[0].set_ylabel("nominal stress [kPa]")
        axes[0].legend(fontsize=8)
        target = PAGE.with_name(f"{name.lower()}.png")
        figure.savefig(target, dpi=90)
        plt.close(figure)
        print(target.relative_to(ROOT))


def notes() -> None:
    """Figures that the text quotes: what a curve costs, and what a free K/G does to a wrong law."""
    for law, terms in LAWS:
        material = parametrisation(law, terms=terms).material(
            parametrisation(law, terms=terms).start(shear=3e4)
        )
        s = np.linspace(1.0, 1.15 if law == "st-venant-kirchhoff" else 2.5, 25)
        for modes in (MODES[:1], MODES):
            taken = []
            for _ in range(200):
                begin = time.process_time()
                nominal_stresses(material, [(mode, s) for mode in modes])
                taken.append(time.process_time() - begin)
            print(
                f"{law} {terms}: {len(modes)} curves of 25 points {1e3 * np.median(taken):.2f} ms of a core"
            )
    free = fit_coupons(parametrisation("mooney-rivlin"), rubber("Kawabata"), held={})
    assert free.identification is not None
    ratio = next(e for e in free.identification.estimates if e.name == "bulk_ratio")
    print(f"mooney-rivlin, Kawabata: K/G {ratio.value:.1f} [{ratio.low:.1f}, {ratio.high:.1f}] {ratio.seen}")


TABLES: dict[str, Callable[[], str]] = {
    "all-modes": all_modes,
    "equal-weights": equal_weights,
    "one-mode": one_mode,
    "parameters": parameters,
    "silicones": silicones,
}

PRINTED: dict[str, Callable[[], None]] = {"pictures": pictures, "notes": notes}


def main(parts: Sequence[str]) -> None:
    if unknown := set(parts) - {*TABLES, *PRINTED}:
        sys.exit(f"expected parts among {', '.join([*TABLES, *PRINTED])}; got {', '.join(sorted(unknown))}")
    real()
    for part in parts or [*TABLES, *PRINTED]:
        begin = time.process_time()
        if part in PRINTED:
            PRINTED[part]()
        else:
            text = TABLES[part]()
            insert(PAGE, part, text)
            print(text)
        print(f"{part}: {time.process_time() - begin:.0f} s of one core", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
