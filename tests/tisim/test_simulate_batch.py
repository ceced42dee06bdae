"""`simulate`: any scenes, in order, bit-identical on one or two workers; homogeneous tests in closed form."""

from __future__ import annotations

import doctest
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from scipy.optimize import brentq

import tisim

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=20e3, bulk_modulus=400e3)
# small Lame parameter: compressible enough for the lateral stretch to matter
SHEAR, BULK = 30e3, 120e3


def scenes() -> list[tisim.Scene]:
    return [
        tisim.Beam(material=SOFT, length=0.05, axial_element_size=0.01, radial_elements=1),
        tisim.Coupon(material=SOFT, stretches=(1.2, 1.5)),
        tisim.Poke(material=SOFT, depth=0.001, refinement=0.5),
        tisim.Beam(
            material=tisim.material_from_moduli("ogden", shear_modulus=15e3, bulk_modulus=1.5e6),
            length=0.05,
            axial_element_size=0.01,
        ),
        tisim.Coupon(material=SOFT, mode="planar", stretches=(0.8,)),
    ]


def test_results_do_not_depend_on_the_workers() -> None:
    one, two = tisim.simulate(scenes(), workers=1), tisim.simulate(scenes(), workers=2)
    for scene, a, b in zip(scenes(), one, two, strict=True):
        assert a.ok
        assert b.ok
        assert type(a.scene) is type(scene)
        for name in ("load", "positions", "support_force", "rod_force", "nominal_stress"):
            one_value, other = getattr(a, name), getattr(b, name)
            assert (one_value is None) == (other is None)
            assert one_value is None or one_value.tobytes() == other.tobytes(), name


def test_progress_counts_to_the_end() -> None:
    seen: list[tuple[float, int]] = []
    tisim.simulate(scenes()[:2], workers=1, on_progress=lambda done, total: seen.append((done, total)))
    assert [(done, total) for done, total in seen if done % 1 == 0] == [(1, 2), (2, 2)]
    assert seen == sorted(seen)  # a scene of several steps counts in fractions


BAD: list[tuple[tisim.Scene, str]] = [
    (tisim.Beam(material=SOFT, length=-0.05), "length"),
    (tisim.Beam(material=SOFT, length=50.0), "length"),
    (tisim.Beam(material=replace(SOFT, density=float("nan")), length=0.05), "density"),
    (tisim.Beam(material=replace(SOFT, law="hooke"), length=0.05), "hooke"),
    (tisim.Beam(material=replace(SOFT, parameters={"mu": 1e4}), length=0.05), "lam"),
    (tisim.Poke(material=SOFT, direction=(1.0, 0.0, -0.1)), "direction"),
    (tisim.Poke(material=SOFT, friction=-0.1), "friction"),
    (tisim.Poke(material=SOFT, depth=5e-10), "depth: expected a length above 1e-09 m"),
    (tisim.Poke(material=SOFT, depth=1e-3, retract_to=1e-3 - 5e-10), "retract_to: expected a depth"),
    (
        tisim.Beam(material=replace(SOFT, parameters=None), length=0.05),
        "expected parameters by name",
    ),
    (tisim.Coupon(material=SOFT, stretches=(0.0,)), "stretch"),
    (tisim.Poke(material=SOFT, refinement=7.0), "refinement"),
    (tisim.Poke(material=SOFT, site=(0.049, 0.0)), "site"),
    (tisim.Poke(material=SOFT, solver=tisim.Solver(method="implicit")), "solver.method: expected static"),
    (tisim.Coupon(material=SOFT, solver=tisim.Solver(method="explicit")), "solver.method: expected static"),
    (
        tisim.Press(material=SOFT, radius=0.01, height=0.01, solver=tisim.Solver(method="implicit")),
        "solver.method: expected static",
    ),
    (
        tisim.Poke(
            material=SOFT,
            block=tisim.Block(inclusion=tisim.SphereInclusion(radius=0.02, centre=(0.0, 0.0, 0.02))),
        ),
        "leaves less than 1 mm",
    ),
]


@pytest.mark.parametrize(("scene", "word"), BAD, ids=[word + str(i) for i, (_, word) in enumerate(BAD)])
def test_bad_scenes_are_refused_by_index_and_field(scene: tisim.Scene, word: str) -> None:
    with pytest.raises(ValueError, match=word) as error:
        tisim.simulate([tisim.Beam(material=SOFT, length=0.05), scene])
    assert "scene 1" in str(error.value)
    assert "\n" not in str(error.value)


Energy = Callable[[float, float, float], float]
C = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)


def energies() -> dict[str, Energy]:
    """The paper's energies of principal stretches, isochoric if the printed one has a stress at rest."""
    p = {
        law: tisim.material_from_moduli(law, shear_modulus=SHEAR, bulk_modulus=BULK).parameters
        for law in tisim.laws.names()
    }

    def i1(a: float, b: float, c: float) -> float:
        return a * a + b * b + c * c

    def bar(a: float, b: float, c: float) -> tuple[float, float, float]:
        j = (a * b * c) ** (1 / 3)
        return a / j, b / j, c / j

    def vol(a: float, b: float, c: float) -> float:
        return 0.5 * BULK * np.log(a * b * c) ** 2

    def number(law: str, name: str) -> float:
        return float(np.asarray(p[law][name]).ravel()[0])

    def green(a: float, b: float, c: float) -> tuple[float, float]:
        e = [(v * v - 1) / 2 for v in (a, b, c)]
        return sum(e), sum(v * v for v in e)

    mu, lam = number("neo-hookean", "mu"), number("neo-hookean", "lam")
    c10, c01 = number("mooney-rivlin", "c10"), number("mooney-rivlin", "c01")
    om, oa = number("ogden", "mu"), number("ogden", "alpha")
    am, al = number("arruda-boyce", "mu"), number("arruda-boyce", "locking")

    def mooney(a: float, b: float, c: float) -> float:
        x, y, z = bar(a, b, c)
        i2 = (x * y) ** 2 + (y * z) ** 2 + (z * x) ** 2
        return c10 * (i1(x, y, z) - 3) + c01 * (i2 - 3) + vol(a, b, c)

    return {
        "st-venant-kirchhoff": lambda a, b, c: lam / 2 * green(a, b, c)[0] ** 2 + mu * green(a, b, c)[1],
        "neo-hookean": lambda a, b, c: (
            mu / 2 * (i1(a, b, c) - 3) - mu * np.log(a * b * c) + lam / 2 * np.log(a * b * c) ** 2
        ),
        "stable-neo-hookean": lambda a, b, c: (
            mu / 2 * (i1(a, b, c) - 3) - mu * (a * b * c - 1) + (lam + mu) / 2 * (a * b * c - 1) ** 2
        ),
        "mooney-rivlin": mooney,
        "ogden": lambda a, b, c: om / oa * (sum(v**oa for v in bar(a, b, c)) - 3) + vol(a, b, c),
        "arruda-boyce": lambda a, b, c: (
            am
            * sum(k / al ** (2 * i) * (i1(*bar(a, b, c)) ** (i + 1) - 3 ** (i + 1)) for i, k in enumerate(C))
            + vol(a, b, c)
        ),
    }


def slope(f: Callable[[float], float], x: float) -> float:
    h = 1e-5
    return float(8 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12 * h)


def closed_form(w: Energy, mode: str, s: float) -> float:
    """Nominal stress along x [Pa]; lateral stretches from zero lateral stress, shear from its energy."""
    if mode == "simple-shear":
        gamma = s - 1
        # principal stretches of simple shear: t, 1, 1/t with t - 1/t = gamma

        def energy(g: float) -> float:
            t = g / 2 + np.sqrt(1 + g * g / 4)
            return w(t, 1.0, 1 / t)

        return slope(energy, gamma)
    pull = {
        "uniaxial": lambda x, t: w(x, t, t),
        "equibiaxial": lambda x, t: w(x, x, t),
        "planar": lambda x, t: w(x, 1.0, t),
    }[mode]
    t = brentq(lambda t: slope(lambda v: pull(s, v), t), 0.3, 2.0, xtol=1e-14)
    return slope(lambda x: pull(x, t), s) / (2 if mode == "equibiaxial" else 1)


@pytest.mark.parametrize("law", tisim.laws.names())
@pytest.mark.parametrize("mode", ["uniaxial", "equibiaxial", "planar", "simple-shear"])
def test_coupons_follow_the_closed_forms(law: str, mode: str) -> None:
    stretches = (0.85, 1.1, 1.4) if mode != "simple-shear" else (1.1, 1.4)
    if (law, mode) == ("st-venant-kirchhoff", "equibiaxial"):
        stretches = (0.85, 1.1, 1.2)  # it has no equilibrium beyond 1.34, see below
    material = tisim.material_from_moduli(law, shear_modulus=SHEAR, bulk_modulus=BULK)
    (result,) = tisim.simulate(
        [tisim.Coupon(material=material, mode=mode, stretches=stretches)],  # type: ignore[arg-type]
        workers=1,
    )
    assert result.ok, result.message
    exact = [closed_form(energies()[law], mode, s) for s in stretches]
    assert result.nominal_stress == pytest.approx(exact, rel=2e-6)


def test_a_coupon_that_would_be_crushed_ends_there() -> None:
    """St Venant-Kirchhoff in equibiaxial tension: at 1.4 only a state of zero volume is in equilibrium."""
    material = tisim.material_from_moduli("st-venant-kirchhoff", shear_modulus=SHEAR, bulk_modulus=BULK)
    coupon = tisim.Coupon(material=material, mode="equibiaxial", stretches=(1.1, 1.2, 1.4))
    (result,) = tisim.simulate([coupon], workers=1)
    assert not result.ok
    assert result.load == pytest.approx([1.1, 1.2])
    assert result.message


def test_export_and_picture(tmp_path: Path) -> None:
    (result,) = tisim.simulate(
        [tisim.Beam(material=SOFT, length=0.05, axial_element_size=0.01, radial_elements=1)], workers=1
    )
    path = tisim.write(result, tmp_path / "beam.vtu")
    back = meshio.read(path)
    # the solved half is shown with its mirror image
    assert len(back.points) > result.mesh.n_nodes
    assert back.points[:, 2].min() == pytest.approx(result.positions[-1][:, 2].min())
    assert back.points[:, 1].min() == pytest.approx(-result.positions[-1][:, 1].max())
    assert tisim.write(result, tmp_path / "beam.ply").stat().st_size > 1000
    tisim.picture(result, tmp_path / "beam.png")
    assert (tmp_path / "beam.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match=r"beam\.pdf: expected a name that ends in \.png"):
        tisim.picture(result, tmp_path / "beam.pdf")
    tisim.write(replace(result, scene=None), tmp_path / "series.pvd")  # without the fields of a scene
    (file,) = (tmp_path / "series").iterdir()
    assert "volume_ratio" in meshio.read(file).cell_data


def test_the_example_in_the_docstring() -> None:
    found = doctest.testmod(tisim)
    assert found.attempted > 0
    assert found.failed == 0


def test_a_body_that_cannot_be_meshed_does_not_lose_the_batch(tmp_path: Path) -> None:
    thin = tisim.BoxInclusion(centre=(0.001, -0.004, 0.005), size=(0.0013, 0.054, 0.01), angle=0.634)
    bad = tisim.Poke(material=SOFT, block=tisim.Block(inclusion=thin), depth=0.001, refinement=0.5)
    first, result, last = tisim.simulate([scenes()[0], bad, scenes()[1]], workers=1)
    assert first.ok
    assert last.ok
    assert result.scene is bad
    assert result.status is tisim.Status.NOT_MESHED
    assert "meets its outline" in result.message
    assert len(result.load) == len(result.positions) == result.mesh.n_nodes == 0
    assert "not-meshed" in repr(result)
    with pytest.raises(ValueError, match="has no frame: inclusion: no grid"):
        tisim.picture(result, tmp_path / "poke.png")
    apart = tisim.simulate([bad, scenes()[0]], workers=2)
    assert [r.status.value for r in apart] == ["not-meshed", "converged"]
