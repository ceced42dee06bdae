"""Synthetic experiments on time-dependent materials: drawn from a seed, written with their truth beside them.

Every test has a virgin specimen of one material. Deviations of beams from the lab's values (length, radius,
density) are drawn from the stated standard deviations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from benchmarks.blind.beams.experiment import as_traced, capture, jittered
from benchmarks.blind.beams.model import Beam
from benchmarks.blind.timed import coupons
from benchmarks.blind.timed.beams import hang
from benchmarks.blind.timed.course import Course, cycles
from benchmarks.blind.timed.indentation import DEEPEST, LAYERS, Push, stored_force
from benchmarks.blind.timed.material import Fibres, Prony, Softening, Solid

Array = NDArray[np.float64]
MATERIAL = "M"
PARTS = ("prony", "mullins", "fibres")
RADIUS, RADIUS_SD, LENGTH_SD, DENSITY, DENSITY_SD = 0.010, 0.05e-3, 0.2e-3, 1000.0, 5.0
PHOTOGRAPHED = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0)  # after release [s]
TRACED = np.linspace(0.02, 1.0, 40)  # fractions of the free length; up to 0.98 in a bridge


@dataclass(frozen=True, kw_only=True)
class CouponTest:
    """A homogeneous test: mode, course of the stretch, standard deviation of the stress [Pa]."""

    id: str
    mode: str
    course: Course
    stress_sd: float


@dataclass(frozen=True, kw_only=True)
class HungBeam:
    """A true beam, the length that the lab states [m], and the times of its photographs [s]."""

    id: str
    beam: Beam
    stated_length: float
    times: tuple[float, ...] = PHOTOGRAPHED


@dataclass(frozen=True, kw_only=True)
class Poke:
    """An indentation: name of its layer, course of the depth, noise as a fraction of the largest force."""

    id: str
    base: str
    course: Course
    noise: float


@dataclass(frozen=True, kw_only=True)
class Case:
    """All tests of one material."""

    seed: int
    kind: str
    solid: Solid
    coupons: tuple[CouponTest, ...] = ()
    beams: tuple[HungBeam, ...] = ()
    pokes: tuple[Poke, ...] = ()

    def truth(self) -> dict[str, Any]:
        """Content of truth.yaml."""
        truth: dict[str, Any] = {
            "seed": self.seed,
            "kind": self.kind,
            "materials": {MATERIAL: self.solid.truth()},
        }
        if self.beams:
            truth["beams"] = {
                b.id: {
                    "length_m": float(b.beam.length),
                    "radius_m": float(b.beam.radius),
                    "density_kg_m3": float(b.beam.density),
                    "bulk_over_shear_modulus": float(b.beam.bulk_ratio),
                }
                for b in self.beams
            }
        return truth


def draw_coupons(seed: int, parts: Sequence[str] = ("prony", "mullins")) -> Case:
    """Uniaxial relaxation, uniaxial cycles of increasing stretch, pure shear and equibiaxial tension.

    `parts` (of PARTS) are the parts of the material besides its Ogden law; ValueError for others.
    """
    unknown = [p for p in parts if p not in PARTS]
    if unknown:
        raise ValueError(f"parts: expected some of {', '.join(PARTS)}, got {', '.join(unknown)}")
    rng = np.random.default_rng([seed, 20])
    shear = float(np.exp(rng.uniform(np.log(1e4), np.log(2e5))))
    alpha = float(rng.uniform(2.0, 4.0))
    solid = Solid(mu=(2.0 * shear / alpha,), alpha=(alpha,))
    top = float(rng.uniform(1.5, 1.9))
    spectrum, worn, fibres = _prony(rng), rng.uniform([1.5, 0.1], [3.0, 0.4]), _fibres(rng, shear)
    if "fibres" in parts:
        solid = replace(solid, fibres=fibres)
    if "mullins" in parts:
        energy = float(solid.energy(np.array([top, top**-0.5, top**-0.5])))
        solid = replace(solid, softening=Softening(r=float(worn[0]), m=float(worn[1]) * energy))
    if "prony" in parts:
        solid = replace(solid, prony=spectrum)
    return _coupons_of(Case(seed=seed, kind="coupons", solid=solid), rng, top)


def _coupons_of(case: Case, rng: np.random.Generator, top: float) -> Case:
    speeds = 10.0 ** rng.uniform(-2.0, -1.0, 4)
    hold, noise = float(rng.uniform(100.0, 300.0)), float(rng.uniform(0.004, 0.01))
    rest = Course(start=1.0)
    growing = tuple(1.0 + part * (top - 1.0) for part in (0.4, 0.7, 1.0))
    courses = {
        "relaxation": (
            "uniaxial",
            rest.ramp(top, speeds[0]).hold(hold).ramp(1.02, speeds[0]).hold(0.5 * hold),
        ),
        "cycles": ("uniaxial", cycles(rest, growing, 1.02, speeds[1])),
        "shear": ("planar", rest.ramp(0.5 * (1.0 + top), speeds[2]).hold(hold)),
        "biaxial": ("equibiaxial", cycles(rest, (1.0 + 0.4 * (top - 1.0),), 1.02, speeds[3])),
    }
    tests = []
    for name, (mode, course) in courses.items():
        largest = float(np.abs(coupons.respond(case.solid, mode, course, tolerance=1e-5).stress).max())
        tests.append(CouponTest(id=name, mode=mode, course=course, stress_sd=noise * largest))
    return replace(case, coupons=tuple(tests))


def draw_beams(seed: int) -> Case:
    """Creeping cantilevers of 60 and 90 mm and a bridge of 150 mm."""
    rng = np.random.default_rng([seed, 21])
    shear = float(np.exp(rng.uniform(np.log(1.8e4), np.log(5e4))))
    return _beams_of(Case(seed=seed, kind="beams", solid=_neo_hookean(shear, _prony(rng))), rng)


def _beams_of(case: Case, rng: np.random.Generator) -> Case:
    radius = RADIUS + RADIUS_SD * float(rng.standard_normal())
    density = DENSITY + DENSITY_SD * float(rng.standard_normal())
    hung = []
    for length, bridge in ((0.060, False), (0.090, False), (0.150, True)):
        beam = Beam(
            length=length + LENGTH_SD * float(rng.standard_normal()),
            bridge=bridge,
            mu=case.solid.shear_modulus,
            density=density,
            radius=radius,
        )
        name = f"{'bridge' if bridge else 'cantilever'}-{1e3 * length:.0f}"
        hung.append(HungBeam(id=name, beam=beam, stated_length=length))
    return replace(case, beams=tuple(hung))


def draw_indentation(seed: int) -> Case:
    """Spherical and flat indenter: ramp, hold, retraction to three tenths of the depth."""
    rng = np.random.default_rng([seed, 22])
    shear = float(np.exp(rng.uniform(np.log(5e3), np.log(1e5))))
    case = Case(seed=seed, kind="indentation", solid=_neo_hookean(shear, _prony(rng)))
    pokes = []
    for base in LAYERS:
        depth = float(rng.uniform(0.8, 1.0)) * DEEPEST[base]
        speed, hold = float(10.0 ** rng.uniform(-3.7, -3.0)), float(rng.uniform(60.0, 150.0))
        course = Course(start=0.0).ramp(depth, speed).hold(hold).ramp(0.3 * depth, speed)
        pokes.append(Poke(id=base, base=base, course=course, noise=float(rng.uniform(0.002, 0.005))))
    return replace(case, pokes=tuple(pokes))


def pushes_of(seed: int) -> dict[str, Push]:
    """Indentations of a seed, by the names under which `stored_force` finds them."""
    case = draw_indentation(seed)
    return {
        f"seed {seed}, {poke.base}": Push(layer=LAYERS[poke.base], prony=case.solid.prony, course=poke.course)
        for poke in case.pokes
    }


def draw_together(seed: int) -> Case:
    """Homogeneous tests and creeping beams of one viscoelastic neo-Hookean material."""
    rng = np.random.default_rng([seed, 23])
    shear = float(np.exp(rng.uniform(np.log(1.8e4), np.log(5e4))))
    case = Case(seed=seed, kind="together", solid=_neo_hookean(shear, _prony(rng)))
    return _beams_of(_coupons_of(case, rng, float(rng.uniform(1.5, 1.9))), rng)


def draw_pushed_and_hung(seed: int) -> Case:
    """Indentations of `draw_indentation`, and creeping beams of the same material."""
    return _beams_of(draw_indentation(seed), np.random.default_rng([seed, 25]))


KINDS: dict[str, Callable[[int], Case]] = {
    "coupons": draw_coupons,
    "beams": draw_beams,
    "indentation": draw_indentation,
    "together": draw_together,
    "pushed-and-hung": draw_pushed_and_hung,
}


def _neo_hookean(shear: float, prony: Prony) -> Solid:
    return Solid(mu=(shear,), alpha=(2.0,), prony=prony)


def _prony(rng: np.random.Generator) -> Prony:
    """Two terms more than a decade apart, inside the time window of the tests."""
    first = float(10.0 ** rng.uniform(-0.2, 0.5))
    second = first * float(10.0 ** rng.uniform(1.1, 1.5))
    fractions = tuple(float(g) for g in rng.uniform(0.12, 0.4, 2))
    return Prony(fractions=fractions, times=(first, second))


def _fibres(rng: np.random.Generator, shear: float) -> Fibres:
    k1, k2, angle = rng.uniform([0.3, 0.2, 15.0], [1.0, 2.0, 75.0])
    return Fibres(k1=float(k1) * shear, k2=float(k2), angle=float(np.radians(angle)))


def write(case: Case, folder: Path, *, noise: float = 1.0) -> None:
    """Write experiment.yaml, its tables and truth.yaml.

    Parameters
    ----------
    noise : float
        Multiplies the stated noise of tables; beams have their full registration and tracing noise unless it
        is 0.
    """
    rng = np.random.default_rng([case.seed, 24])
    folder.mkdir(parents=True)
    trials = [_write_coupon(case, test, folder, noise, rng) for test in case.coupons]
    trials += [_write_beam(case, hung, folder, noise, rng) for hung in case.beams]
    trials += [_write_poke(case, poke, folder, noise, rng) for poke in case.pokes]
    known: dict[str, Any] = {"density_kg_m3": DENSITY, "density_sd_kg_m3": DENSITY_SD} if case.beams else {}
    experiment = {
        "format": 1,
        "name": f"timed {case.kind} {case.seed}",
        "notes": "made by a solver that is not under test",
        "materials": {MATERIAL: known},
        "trials": trials,
    }
    for name, content in (("experiment", experiment), ("truth", case.truth())):
        text = yaml.safe_dump(content, sort_keys=False)
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")


def _write_coupon(
    case: Case, test: CouponTest, folder: Path, noise: float, rng: np.random.Generator
) -> dict[str, Any]:
    found = coupons.respond(case.solid, test.mode, test.course, tolerance=1e-7)
    stress = found.stress + noise * test.stress_sd * rng.standard_normal(len(found.stress))
    rows = [
        f"{t:.8g},{s:.8g},{1e-3 * p:.7g}" for t, s, p in zip(found.time, found.stretch, stress, strict=True)
    ]
    _table(folder, f"coupons/{test.id}.csv", "time_s,stretch,nominal_stress_kPa", rows)
    return {
        "id": test.id,
        "kind": "coupon",
        "material": MATERIAL,
        "mode": test.mode,
        "record": f"coupons/{test.id}.csv",
        "stress_sd_kPa": round(1e-3 * test.stress_sd, 9),
    }


def _write_beam(
    case: Case, hung: HungBeam, folder: Path, noise: float, rng: np.random.Generator
) -> dict[str, Any]:
    shapes = hang(hung.beam, case.solid.prony, hung.times)
    traced = TRACED[TRACED <= 0.98] if hung.beam.bridge else TRACED
    captures = []
    (folder / "beams").mkdir(exist_ok=True)
    for time, shape in zip(hung.times, shapes, strict=True):
        name = f"beams/{hung.id}-t{time:g}.csv"
        edges = shape.edges(jittered(traced, rng))
        text = as_traced(edges, rng) if noise else _outline(edges)
        (folder / name).write_text(text, encoding="utf-8")
        captures.append(capture(name, time))
    return {
        "id": hung.id,
        "kind": "beam",
        "material": MATERIAL,
        "section": {"circle": {"radius_mm": 1e3 * RADIUS, "radius_sd_mm": 1e3 * RADIUS_SD}},
        "free_length_mm": round(1e3 * hung.stated_length, 6),
        "free_length_sd_mm": 1e3 * LENGTH_SD,
        "grip_length_mm": 20.0,
        "supports": "clamped-clamped" if hung.beam.bridge else "clamped-free",
        "gravity_m_s2": [0.0, 0.0, -9.81],
        "captures": captures,
    }


def _outline(edges: Array) -> str:
    lines = ["side,x_mm,z_mm"]
    for side, edge in zip(("upper", "lower"), edges, strict=True):
        lines += [f"{side},{1e3 * x:.6f},{1e3 * z:.6f}" for x, z in edge]
    return "\n".join(lines) + "\n"


def _write_poke(
    case: Case, poke: Poke, folder: Path, noise: float, rng: np.random.Generator
) -> dict[str, Any]:
    times = poke.course.record_times()
    clean = case.solid.shear_modulus * stored_force(f"seed {case.seed}, {poke.base}", poke.course, times)
    force_sd = poke.noise * float(np.abs(clean).max())
    force = clean + noise * force_sd * rng.standard_normal(len(clean))
    depth = poke.course.value(times)
    rows = [f"{t:.8g},{1e3 * d:.8g},{f:.7g}" for t, d, f in zip(times, depth, force, strict=True)]
    _table(folder, f"pokes/{poke.id}.csv", "time_s,depth_mm,force_N", rows)
    layer = LAYERS[poke.base]
    return {
        "id": poke.id,
        "kind": "poke",
        "material": MATERIAL,
        "block_mm": [2e3 * layer.side, 2e3 * layer.side, 1e3 * layer.height],
        "rod": {"radius_mm": 1e3 * layer.rod, "tip": layer.tip},
        "start_mm": [0.0, 0.0, 1e3 * layer.height],
        "direction": [0.0, 0.0, -1.0],
        "record": f"pokes/{poke.id}.csv",
        "force_sd_N": float(f"{force_sd:.6g}"),
    }


def _table(folder: Path, name: str, header: str, rows: list[str]) -> None:
    (folder / name).parent.mkdir(exist_ok=True)
    (folder / name).write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
