"""What the corrections are worth: the modulus error that each shortcut alone causes (docs/corrections.md).

python docs/corrections_study.py            (all of it: about a quarter of an hour of one core)
python docs/corrections_study.py default linear faceted stop picture     (those parts)

The made experiment measured/bench/clean is found by TISIM_MEASURED, or in ../shared/measured. Its truth.yaml
is read for the percentages alone. Tables go into docs/corrections.md between their markers, and the picture
is drawn from what stands there.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import matplotlib
import numpy as np
import yaml
from numpy.typing import NDArray

matplotlib.use("Agg")
from matplotlib import pyplot as plt

import tisim
from calibration.experiment import BeamTrial, read
from calibration.outlines import COARSE, REFERENCE, Fidelity, OutlineObjective
from calibration.parameters import parametrisation
from calibration.search import Problem, guess, polish
from tisim.mesh.beam import PAPER_LAYER, PAPER_RINGS
from tisim.paper_stop import paper_stop

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "corrections.md"
PICTURE = ROOT / "docs" / "pictures" / "corrections.png"
BENCH = Path(os.environ.get("TISIM_MEASURED", ROOT.parent / "shared" / "measured")) / "bench" / "clean"
MIXTURES = ("S0", "S0.5", "S1")
RATIOS = (20.0, 100.0, 1000.0)  # K/G; the bench was made with 1000
POLYGONS = {12: 2, 30: 5}  # sides of the inscribed section: rings of elements
# Rayleigh coefficients [1/s] and [s]; SOFA's customary ones are 0.1 and 0.1
DAMPINGS = ((0.1, 0.01), (0.1, 0.1), (0.1, 0.3))
FACTORS = np.geomspace(0.22, 1.3, 7)  # of the default fit's modulus: where runs are made
STOP_STEP = 5e-3  # [s] of the dynamic runs; the rule's window is 50 ms
LONGEST = 4.0  # [s] that a run may take to be stopped


@dataclass(frozen=True)
class Fitted:
    """shear [Pa] (NaN: none found); misfit there, as the fit says; steps of Gauss-Newton."""

    shear: float
    misfit: float
    steps: int


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


@cache
def default_fit(mixture: str) -> Fitted:
    """Shear modulus and K/G by Gauss-Newton; leaves the objective linearised there."""
    likelihood = objective(mixture)
    problem = Problem(parametrisation=parametrisation("neo-hookean"), objectives=(likelihood,))
    likelihood.reference = None
    start = guess(problem)
    likelihood.reference = REFERENCE
    if start is None:
        raise SystemExit(f"{mixture}: no start found")
    end = polish(problem, start)
    if not end.converged:
        raise SystemExit(f"{mixture}: the default fit did not converge: {end.message}")
    shear = problem.parametrisation.moduli(end.u).shear
    return Fitted(shear, end.cost / (problem.points - len(end.u)), end.steps)


def material(shear: float, ratio: float) -> tisim.Material:
    return tisim.material_from_moduli("neo-hookean", shear=shear, bulk=ratio * shear)


def uncorrected(mixture: str, kind: type[OutlineObjective], fidelity: Fidelity) -> OutlineObjective:
    """The same photographs, another simulation, no mesh correction."""
    known = objective(mixture)
    return kind(known.trials, known.belief, fidelity=fidelity, reference=None, workers=1)


def distances(likelihood: OutlineObjective, materials: Sequence[tisim.Material]) -> Array:
    """Distances of all points as measured, nothing taken out, (batch, points) [m]; NaN without an answer."""
    found = np.full((len(materials), likelihood.points), np.nan)
    for k, results in enumerate(likelihood.simulate(materials)):
        if all(r.ok for r in results):
            found[k] = distances_of(likelihood, results)
    return found


def distances_of(likelihood: OutlineObjective, results: Sequence[tisim.Result]) -> Array:
    seen = [f.distance for p in likelihood.photographs for f in likelihood.distances(results, p)]
    return np.asarray(np.concatenate(seen))


def least_squares(likelihood: OutlineObjective, ratio: float, start: float) -> Fitted:
    """Modulus of least squared distance; `misfit` in m."""
    found = _gauss_newton(lambda m: distances(likelihood, m), ratio, start)
    return replace(found, misfit=float(np.sqrt(found.misfit / likelihood.points)))


def _gauss_newton(
    residuals: Callable[[Sequence[tisim.Material]], Array], ratio: float, start: float
) -> Fitted:
    """Gauss-Newton on the logarithm of the shear modulus alone, K/G held; ends below 0.1 % a step."""
    log, ahead = float(np.log(start)), 0.01
    for step in range(1, 13):
        here, there = residuals([material(np.exp(log + d), ratio) for d in (0.0, ahead)])
        if not np.isfinite([here, there]).all():
            return Fitted(float("nan"), float("nan"), step)
        slope = (there - here) / ahead
        move = float(np.clip(-(slope @ here) / (slope @ slope), -0.5, 0.5))
        log += move
        if abs(move) < 1e-3:
            return Fitted(float(np.exp(log)), float(here @ here), step)
    return Fitted(float("nan"), float("nan"), 12)


class Faceted(OutlineObjective):
    """Quadratic elements with straight sides in a polygon inscribed in the section's circle."""

    def simulate(self, materials: Sequence[tisim.Material]) -> list[list[tisim.Result]]:
        meshes = [inscribed(t, self.fidelity) for t in self.trials]
        results = tisim.simulate(
            [
                replace(self._beam(t, m), mesh=mesh)
                for t, mesh in zip(self.trials, meshes, strict=True)
                for m in materials
            ],
            workers=self.workers,
        )
        n = len(materials)
        return [[results[i * n + k] for i in range(len(self.trials))] for k in range(n)]


@cache
def _inscribed(length: float, radius: float, supports: str, layer: float, rings: int) -> tisim.Mesh:
    plain = tisim.mesh.beam_mesh(
        length=length,
        section=tisim.Circle(radius=radius),
        supports=supports,  # type: ignore[arg-type]
        kind="tet4",
        layer=layer,
        rings=rings,
        mirror=True,
    )
    nodes = plain.nodes.copy()
    nodes[:, 1:] *= radius / np.hypot(nodes[:, 1], nodes[:, 2]).max()
    return tisim.mesh.to_quadratic(replace(plain, nodes=nodes))


def inscribed(trial: BeamTrial, fidelity: Fidelity) -> tisim.Mesh:
    assert isinstance(trial.section, tisim.Circle)
    return _inscribed(trial.free_length, trial.section.radius, trial.supports, fidelity.layer, fidelity.rings)


class Stopped(OutlineObjective):
    """Beams released from the straight shape, seen where the paper's rule stops the run."""

    damping = DAMPINGS[0]

    def simulate(self, materials: Sequence[tisim.Material]) -> list[list[tisim.Result]]:
        return [[self._stopped(self._beam(t, m)) for t in self.trials] for m in materials]

    def _stopped(self, beam: tisim.Beam) -> tisim.Result:
        duration = 0.5
        while True:
            mass, stiffness = self.damping
            solver = tisim.Solver(
                method="implicit",
                tolerance=1e-4,
                duration=duration,
                time_step=STOP_STEP,
                mass_damping=mass,
                stiffness_damping=stiffness,
            )
            (run,) = tisim.simulate([replace(beam, solver=solver)], workers=1)
            # the rule itself does not look at the equilibrium; the distance from it is not asked for
            stop = paper_stop(run, run.mesh.nodes) if len(run.load) else None
            if stop is not None:
                at = int(np.argmin(np.abs(run.load - stop.time)))
                return replace(run, status=tisim.Status.CONVERGED, positions=run.positions[at][None])
            if not run.ok or duration >= LONGEST:
                return replace(run, status=tisim.Status.UNFINISHED)
            duration *= 2


def default() -> list[list[str]]:
    """The default fit, and by least squares with K/G held."""
    rows = []
    for mixture in MIXTURES:
        fit = default_fit(mixture)
        error = _signed(percent(mixture, fit.shear))
        rows.append([mixture, "default, likelihood", error, f"chi2/n {fit.misfit:.2f}"])
        note(f"{rows[-1]}")
        likelihood = uncorrected(mixture, OutlineObjective, Fidelity())
        for ratio in RATIOS:
            squares = least_squares(likelihood, ratio, fit.shear)
            rows.append(_row(f"default, K/G {ratio:.0f}", mixture, squares))
    return rows


def linear() -> list[list[str]]:
    """Plain 4-node tetrahedra at the paper's fineness."""
    rows = []
    fidelity = Fidelity(element="tet4", layer=PAPER_LAYER, rings=PAPER_RINGS)
    for mixture in MIXTURES:
        likelihood = uncorrected(mixture, OutlineObjective, fidelity)
        start = default_fit(mixture).shear
        for ratio in RATIOS:
            squares = least_squares(likelihood, ratio, start)
            start = squares.shear if np.isfinite(squares.shear) else start
            rows.append(_row(f"4-node, K/G {ratio:.0f}", mixture, squares))
    return rows


def faceted() -> list[list[str]]:
    """The section as an inscribed polygon, all else as by default (K/G 300 held)."""
    rows = []
    for mixture in MIXTURES:
        for sides, rings in POLYGONS.items():
            likelihood = uncorrected(mixture, Faceted, Fidelity(rings=rings))
            squares = least_squares(likelihood, 300.0, default_fit(mixture).shear)
            rows.append(_row(f"{sides} sides", mixture, squares))
    return rows


def stop() -> list[list[str]]:
    """Shapes from the paper's rule on a grid of moduli; the modulus that takes them for the photographs."""
    rows = []
    for mixture in MIXTURES:
        shear = default_fit(mixture).shear
        likelihood = uncorrected(mixture, Stopped, COARSE)
        assert isinstance(likelihood, Stopped)
        static = OutlineObjective.simulate(likelihood, [material(shear, 300.0)])[0]
        for damping in DAMPINGS:
            likelihood.damping = damping
            begun = time.process_time()
            runs = likelihood.simulate([material(f * shear, 300.0) for f in FACTORS])
            each = [
                invert([r[i] for r in runs], deflection(static[i])) for i in range(len(likelihood.trials))
            ]
            joint, misfit = nearest(likelihood, runs)
            cells = [percent(mixture, f * shear) for f in (joint, *each)]
            label = f"{damping[0]:g} / {damping[1]:g}"
            rows.append([mixture, label, *(_signed(c) for c in cells), f"{1e3 * misfit:.2f}"])
            note(f"{mixture} {label}: {rows[-1][2:]} ({time.process_time() - begun:.0f} core-s)")
    return rows


def deflection(result: tisim.Result) -> float:
    """Largest way down of any node [m]; NaN without a shape."""
    if not result.ok:
        return float("nan")
    return float((result.mesh.nodes[:, 2] - result.positions[-1][:, 2]).max())


def invert(results: Sequence[tisim.Result], wanted: float) -> float:
    """Factor on the modulus at which the deflection is the wanted one, by interpolation in logarithms;
    NaN where the grid does not hold it exactly once."""
    down = np.array([deflection(r) for r in results])
    good = np.isfinite(down)
    x, y = np.log(FACTORS[good]), np.log(down[good] / wanted)
    crossing = np.flatnonzero(np.signbit(y[1:]) != np.signbit(y[:-1]))
    if len(crossing) != 1:
        return float("nan")
    k = crossing[0]
    return float(np.exp(x[k] - y[k] * (x[k + 1] - x[k]) / (y[k + 1] - y[k])))


def nearest(likelihood: Stopped, runs: Sequence[Sequence[tisim.Result]]) -> tuple[float, float]:
    """Factor on the modulus of least squared distance over all photographs, and its rms [m]; NaN where it
    lies at an end of the grid. Distances are interpolated between the moduli."""
    good = [k for k, r in enumerate(runs) if all(one.ok for one in r)]
    if len(good) < 3:
        return float("nan"), float("nan")
    known = np.array([distances_of(likelihood, runs[k]) for k in good])
    x = np.log(FACTORS[good])
    fine = np.linspace(x[0], x[-1], 2001)
    cost = np.array([(_between(x, known, at) ** 2).mean() for at in fine])
    best = int(cost.argmin())
    if best in (0, len(fine) - 1):
        return float("nan"), float("nan")
    return float(np.exp(fine[best])), float(np.sqrt(cost[best]))


def _between(x: Array, rows: Array, at: float) -> Array:
    k = int(np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2))
    share = (at - x[k]) / (x[k + 1] - x[k])
    return np.asarray((1 - share) * rows[k] + share * rows[k + 1])


def _row(label: str, mixture: str, squares: Fitted) -> list[str]:
    row = [mixture, label, _signed(percent(mixture, squares.shear)), f"{1e3 * squares.misfit:.2f}"]
    note(f"{label}, {mixture}: {row[2:]}, {squares.steps} steps")
    return row


def _signed(value: float) -> str:
    return f"{value:+.1f}" if np.isfinite(value) else "none"


BEGUN = time.process_time()


def note(line: str) -> None:
    print(f"[{time.process_time() - BEGUN:5.0f} core-s] {line}", flush=True)


FIT_HEAD = ("mixture", "simulated with", "error [%]", "rms [mm]")
STOP_HEAD = ("mixture", "damping [1/s] / [s]", "least squares: error [%]", "50 mm alone", "100 mm", "150 mm",
             "rms [mm]")  # fmt: skip
PARTS: dict[str, tuple[Sequence[str], Callable[[], list[list[str]]]]] = {
    "default": (FIT_HEAD, default),
    "linear": (FIT_HEAD, linear),
    "faceted": (FIT_HEAD, faceted),
    "stop": (STOP_HEAD, stop),
}


def write_table(name: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Put a table between its markers in the page."""
    lines = ["| " + " | ".join(r) + " |" for r in (head, ["---"] * len(head), *rows)]
    text = PAGE.read_text(encoding="utf-8")
    first, last = f"<!-- {name} -->\n", f"\n<!-- end {name} -->"
    before, _, rest = text.partition(first)
    _, end, after = rest.partition(last)
    if not end:
        raise SystemExit(f"{PAGE}: expected the markers of {name}")
    PAGE.write_text(before + first + "\n".join(lines) + last + after, encoding="utf-8")


def read_table(name: str) -> list[list[str]]:
    """Rows of a table of the page, without its head."""
    text = PAGE.read_text(encoding="utf-8")
    body = text.partition(f"<!-- {name} -->\n")[2].partition(f"<!-- end {name} -->")[0]
    return [[c.strip() for c in line.strip("| ").split("|")] for line in body.splitlines()[2:]]


def picture() -> None:
    """Modulus error of each way, one bar a mixture."""
    cases: dict[str, dict[str, float]] = {}
    for name in ("default", "linear", "faceted", "stop"):
        for row in read_table(name):
            label = {"faceted": f"inscribed\n{row[1]}", "stop": f"stopping rule\n{row[1]}"}.get(name, row[1])
            error = row[2]
            cases.setdefault(label, {})[row[0]] = float("nan") if error == "none" else float(error)
    figure, axes = plt.subplots(figsize=(11, 4.4), layout="constrained")
    for k, mixture in enumerate(MIXTURES):
        at = np.arange(len(cases)) + 0.27 * (k - 1)
        values = [v.get(mixture, np.nan) for v in cases.values()]
        axes.bar(at, values, 0.25, color=f"C{k}", label=mixture)
        for x, value in zip(at, values, strict=True):
            if np.isnan(value):
                axes.text(x, 0, "none", rotation=90, ha="center", va="bottom", fontsize=7)
                continue
            up = value >= 0
            axes.text(x, value, f"{value:+.1f}", ha="center", va="bottom" if up else "top", fontsize=6.5)
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(-150, 30)
    axes.set_yticks([-100, -30, -10, -3, -1, 0, 1, 3, 10, 30])
    axes.yaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.set_xticks(np.arange(len(cases)), [c.replace(", ", "\n") for c in cases], fontsize=7.5)
    axes.axhline(0, color="0.3", lw=0.8)
    axes.grid(axis="y", alpha=0.3)
    axes.set_ylabel("error of the fitted shear modulus [%]")
    axes.legend(frameon=False, loc="lower left")
    figure.savefig(PICTURE, dpi=130)
    print(PICTURE.relative_to(ROOT))


def main() -> None:
    wanted = sys.argv[1:] or [*PARTS, "picture"]
    if unknown := [name for name in wanted if name not in (*PARTS, "picture")]:
        raise SystemExit(f"no such part: {', '.join(unknown)}; there are {', '.join(PARTS)}, picture")
    for name in wanted:
        if name == "picture":
            picture()
            continue
        head, make = PARTS[name]
        write_table(name, head, make())


if __name__ == "__main__":
    main()
