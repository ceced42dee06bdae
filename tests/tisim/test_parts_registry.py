"""Parts of a material: registered from outside, checked, refused by scenes that would ignore them."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from other_process import python

import tisim
from tisim import parts, problems

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=2e4, bulk_modulus=1e6)
PRONY = tisim.Prony(fractions=(0.4,), times=(2.0,))
MULLINS = tisim.OgdenRoxburgh(r=2.0, m=1e3)
FIBRES = tisim.HolzapfelGasserOgden(direction=(1.0, 0.0, 0.0), k1=1e4)
HANG = tisim.Course().jump(1.0).hold(10.0)

MINE = '''
"""A line of relaxation times, a softening in proportion, and straight fibres: parts of somebody else's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from tisim import parts
from tisim.laws import ti


@dataclass(frozen=True, kw_only=True)
class LogTime(parts.Viscosity):
    name: ClassVar[str] = "log-time"
    title: ClassVar[str] = "Log-time relaxation"
    part: float

    def check(self):
        if not self.part >= 0.0:
            raise ValueError(f"part: expected a part of 0 or more, got {self.part!r}")

    def spectrum(self):
        times = 10.0 ** np.arange(-1.0, 2.25, 0.5)
        return parts.Spectrum(equilibrium=1.0, strengths=np.full(len(times), self.part / 2), times=times)


@ti.func
def soft(W, largest, prm):
    lost = 1.0 - prm[0]
    f = ti.Vector([W - 0.5 * lost * largest, 1.0, 0.0])
    if W < largest:
        part = W / largest
        f = ti.Vector([W - lost * W * (1.0 - 0.5 * part), 1.0 - lost * (1.0 - part), lost / largest])
    return f


@dataclass(frozen=True, kw_only=True)
class Half(parts.Softening):
    name: ClassVar[str] = "half"
    title: ClassVar[str] = "Softer in proportion"
    energy: ClassVar[Any] = soft
    left: float

    def check(self): ...

    def pack(self):
        return np.array([self.left])

    def dissipated(self, largest):
        return 0.5 * (1.0 - self.left) * largest


@ti.func
def straight(I4, prm):
    return ti.Vector([0.5 * prm[0] * (I4 - 1.0) ** 2, prm[0] * (I4 - 1.0), prm[0]])


@dataclass(frozen=True, kw_only=True)
class Straight(parts.Fibres):
    name: ClassVar[str] = "straight"
    title: ClassVar[str] = "Fibres that carry compression"
    energy: ClassVar[Any] = straight
    stiffness: float

    def check(self): ...

    def pack(self):
        return np.array([self.stiffness])


for part in (LogTime, Half, Straight):
    parts.register(part)
'''
MAIN = """
import sys

import numpy as np
import tisim

if __name__ == "__main__":
    import my_parts

    soft = tisim.material_from_moduli("yeoh", shear_modulus=2e4, bulk_modulus=1e6)
    mine = tisim.Material(
        law=soft.law, parameters=soft.parameters, viscosity=my_parts.LogTime(part=0.05),
        softening=my_parts.Half(left=0.5), fibres=my_parts.Straight(direction=(0, 0, 1), stiffness=1e4),
    )
    pull = tisim.Course(start=1.0).ramp(to=1.4, speed=0.1).ramp(to=1.1, speed=0.1)
    scenes = [tisim.Coupon(material=mine, course=pull, mode=mode) for mode in ("uniaxial", "planar")]
    hang = tisim.Course().jump(1.0).hold(1.0)
    small = {"length": 0.02, "axial_element_size": 0.01, "radial_elements": 1}
    scenes.append(tisim.Beam(material=mine, course=hang, **small))
    results = tisim.simulate(scenes, workers=int(sys.argv[1]))
    assert all(r.ok for r in results)
    np.savez(sys.argv[2], *[r.positions for r in results])
"""


@pytest.fixture
def mine(tmp_path: Path) -> Iterator[ModuleType]:
    (tmp_path / "my_parts.py").write_text(MINE)
    sys.path.insert(0, str(tmp_path))
    try:
        import my_parts

        yield my_parts
    finally:
        sys.path.remove(str(tmp_path))
        sys.modules.pop("my_parts", None)
        for name in ("log-time", "half", "straight"):
            parts.unregister(name)


def test_parts_from_a_file_are_found_and_solved(mine: ModuleType) -> None:
    assert parts.names() == (
        "prony", "ogden-roxburgh", "holzapfel-gasser-ogden", "log-time", "half", "straight",
    )  # fmt: skip
    assert parts.get("half") is mine.Half
    material = replace(SOFT, softening=mine.Half(left=0.25))
    F = np.array([np.diag([s, s**-0.5, s**-0.5]) for s in (1.5, 1.2)])
    found, law = (parts.respond(m, [0.0, 0.0], F).stress[:, 0] for m in (material, SOFT))
    assert np.array_equal(found[0], law[0])
    deviator = [
        np.diag(f @ s.T - np.trace(f @ s.T) / 3 * np.eye(3)) for f, s in ((F[1], found[1]), (F[1], law[1]))
    ]
    energy = [s**2 + 2.0 / s - 3.0 for s in (1.2, 1.5)]
    assert deviator[0] == pytest.approx((1.0 - 0.75 * (1.0 - energy[0] / energy[1])) * deviator[1], rel=1e-9)


def test_parts_from_a_file_reach_other_processes(mine: ModuleType, tmp_path: Path) -> None:
    assert mine.__file__ == str(tmp_path / "my_parts.py")
    (tmp_path / "main.py").write_text(MAIN)
    found = []
    # one after the other: the first process caches the kernels on disk
    for workers in ("1", "2"):
        out = tmp_path / f"{workers}.npz"
        python(tmp_path, str(tmp_path / "main.py"), workers, str(out))
        with np.load(out) as saved:
            found.append([saved[name] for name in saved.files])
    here, there = found
    assert len(here) == len(there) == 3
    assert all(np.array_equal(a, b) for a, b in zip(here, there, strict=True))


def test_what_is_no_part_is_refused() -> None:
    with pytest.raises(TypeError, match="a dataclass that derives from Viscosity, Softening or Fibres"):
        parts.register(int)  # type: ignore[type-var]

    @dataclass(frozen=True, kw_only=True)
    class Other(tisim.Prony):
        name = "prony"

    with pytest.raises(ValueError, match="'prony' is a part of tisim's own"):
        parts.register(Other)
    with pytest.raises(
        ValueError, match="expected one of prony, ogden-roxburgh, holzapfel-gasser-ogden, got"
    ):
        parts.get("maxwell")


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"viscosity": replace(PRONY, times=(-1.0,))}, r"viscosity\.times: expected one or more relaxation"),
        ({"viscosity": replace(PRONY, times=(0.0,))}, r"viscosity\.times: expected one or more relaxation"),
        ({"viscosity": tisim.Prony(fractions=(0.1, 0.1), times=(3.0, 3.0))}, "which no two are alike"),
        ({"viscosity": replace(PRONY, times=(1.0, 2.0))}, "as many as there are fractions, 1, got"),
        ({"viscosity": replace(PRONY, fractions=(-0.1,))}, r"viscosity\.fractions: expected one or more"),
        ({"viscosity": replace(PRONY, fractions=(float("nan"),))}, r"viscosity\.fractions: expected one"),
        ({"viscosity": replace(PRONY, fractions=())}, r"viscosity\.fractions: expected one or more"),
        ({"viscosity": replace(PRONY, fractions=0.4)}, r"viscosity\.fractions: expected one or more"),
        (
            {"viscosity": tisim.Prony(fractions=(0.6, 0.4), times=(1.0, 2.0), modulus="instantaneous")},
            "parts of the instantaneous modulus that sum to less than 1, got",
        ),
        ({"viscosity": replace(PRONY, modulus="short")}, r"viscosity\.modulus: expected one of long-time"),
        ({"viscosity": MULLINS}, r"material\.viscosity: expected Viscosity, got 'OgdenRoxburgh'"),
        ({"softening": replace(MULLINS, r=0.9)}, r"softening\.r: expected a number of 1 or more, got 0.9"),
        ({"softening": replace(MULLINS, m=0.0)}, r"softening\.m: expected an energy above 0 J/m3"),
        ({"softening": replace(MULLINS, beta=-0.1)}, r"softening\.beta: expected a number not below 0"),
        ({"fibres": replace(FIBRES, direction=(0.0, 0.0, 0.0))}, r"fibres\.direction: expected a direction"),
        ({"fibres": replace(FIBRES, direction=(1.0, 0.0))}, r"fibres\.direction: expected 3 finite numbers"),
        ({"fibres": replace(FIBRES, k1=-1.0)}, r"fibres\.k1: expected a stiffness of 0 Pa or more"),
        ({"fibres": replace(FIBRES, k2=-1.0)}, r"fibres\.k2: expected a number not below 0"),
    ],
)  # fmt: skip
def test_parts_that_cannot_be_are_refused_in_one_sentence(changes: dict[str, object], sentence: str) -> None:
    scene = tisim.Coupon(material=replace(SOFT, **changes), course=tisim.Course(start=1.0).jump(1.2))
    with pytest.raises(ValueError, match=sentence) as error:
        tisim.simulate(scene)
    assert str(error.value).startswith("scene 0: Coupon.material.")
    assert "\n" not in str(error.value)


BEAM = tisim.Beam(material=SOFT, length=0.05)


@pytest.mark.parametrize(
    ("scene", "sentence"),
    [
        (
            tisim.Coupon(material=replace(SOFT, viscosity=PRONY)),
            "Coupon.course: expected a tisim.Course, since the",
        ),
        (
            tisim.Poke(material=replace(SOFT, viscosity=PRONY)),
            "Poke.course: expected a tisim.Course, since the",
        ),
        (
            tisim.Press(material=replace(SOFT, viscosity=PRONY), radius=0.01, height=0.01),
            "Press.course: expected a tisim.Course, since the",
        ),
        (
            replace(BEAM, material=replace(SOFT, viscosity=PRONY)),
            "Beam.course: expected a tisim.Course, since the",
        ),
        (
            replace(BEAM, material=replace(SOFT, softening=MULLINS)),
            "Beam.course: expected a tisim.Course, since the",
        ),
        (
            replace(BEAM, material=replace(SOFT, viscosity=PRONY), solver=tisim.Solver(method="explicit")),
            r"Beam.material.viscosity: expected None, since this Beam does not take it into account",
        ),
        (
            replace(BEAM, course=HANG, solver=tisim.Solver(method="implicit")),
            "Beam.course: expected None for a dynamic beam",
        ),
        (
            replace(
                BEAM,
                material=replace(SOFT, viscosity=PRONY),
                solver=tisim.Solver(method="implicit", until_rest=True),
            ),
            "Beam.solver.until_rest: expected False for a viscous beam",
        ),
        (
            replace(
                BEAM,
                course=tisim.Course().ramp(to=1.0, speed=1.0),
                clamp_imperfections=tisim.ClampImperfections(tilt=0.1),
            ),
            r"course.values: expected the whole load at once, jump\(1.0\)",
        ),
        (
            tisim.Press(
                material=replace(SOFT, fibres=replace(FIBRES, direction=(1.0, 1.0, 0.0))),
                radius=0.01,
                height=0.01,
            ),
            "Press.material.fibres.direction: expected a direction along x, y or z",
        ),
    ],
)
def test_no_part_is_silently_ignored(scene: tisim.Scene, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        tisim.simulate(scene)


def test_a_kind_of_scene_that_says_nothing_of_parts_takes_none() -> None:
    @dataclass(frozen=True, kw_only=True)
    class Other:
        material: tisim.Material
        solver: tisim.Solver = field(default_factory=tisim.Solver)

    problems.register(problems.SceneKind(scene=Other, solve=lambda scene, _: scene))
    try:
        for part in ({"viscosity": PRONY}, {"softening": MULLINS}, {"fibres": FIBRES}):
            with pytest.raises(ValueError, match="since this Other does not take it into account"):
                tisim.simulate(Other(material=replace(SOFT, **part)))  # type: ignore[call-overload]
    finally:
        problems.unregister(Other)
