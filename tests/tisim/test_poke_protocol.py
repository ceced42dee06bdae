"""Complete indentations: balance of forces, penetration, frames, friction, an FElupe reference, failures."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import tisim
from tisim.problems.indentation.first_touch import plane_contact
from tisim.problems.indentation.solve import solve_poke

REFERENCE = json.loads(
    (Path(__file__).parents[2] / "benchmarks" / "references" / "poke.json").read_text(encoding="utf-8")
)
SHEAR, BULK = 30e3, 600e3
SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=SHEAR, bulk_modulus=BULK)
_YOUNG = 9 * BULK * SHEAR / (3 * BULK + SHEAR)
_POISSON = (3 * BULK - 2 * SHEAR) / (2 * (3 * BULK + SHEAR))
PLANE_MODULUS = _YOUNG / (1 - _POISSON**2)


def poke(**changes: object) -> tisim.Poke:
    """Indentation of 2 mm on the coarsest mesh by default."""
    return tisim.Poke(**({"material": SOFT, "depth": 0.002, "refinement": 0.5} | changes))  # type: ignore[arg-type]


def tilted(degrees: float) -> tuple[float, float, float]:
    angle = np.radians(degrees)
    return float(np.sin(angle)), 0.0, -float(np.cos(angle))


@pytest.fixture(scope="module")
def results() -> dict[str, tisim.Result]:
    scenes = {
        "normal": poke(),
        "slippery": poke(friction=0.0),
        "tilted": poke(direction=tilted(30.0)),
        "tilted slippery": poke(direction=tilted(30.0), friction=0.0),
        "hemisphere": poke(rod=tisim.Rod(tip="hemisphere")),
    }
    return {name: solve_poke(scene) for name, scene in scenes.items()}


NAMES = ("normal", "slippery", "tilted", "tilted slippery", "hemisphere")


@pytest.mark.parametrize("name", NAMES)
def test_rod_force_is_base_reaction(results: dict[str, tisim.Result], name: str) -> None:
    result = results[name]
    assert result.ok
    size = np.linalg.norm(result.rod_force, axis=1)
    assert (size > 0.01).all()
    # the reaction on the indenter equals the reaction of the base
    assert np.linalg.norm(result.rod_force - result.support_force, axis=1) == pytest.approx(
        0, abs=0.01 * size[0]
    )


@pytest.mark.parametrize("name", NAMES)
def test_frames_are_good(results: dict[str, tisim.Result], name: str) -> None:
    result = results[name]
    assert result.load == pytest.approx([0.001, 0.002])
    assert isinstance(result.scene, tisim.Poke)
    assert (result.penetration < 0.5 * result.scene.rod.edge_radius).all()
    assert (result.min_jacobian > 0).all()
    assert (result.residual <= result.scene.solver.tolerance).all()
    moved = np.linalg.norm(np.diff(result.rod_tip, axis=0), axis=1)
    assert moved == pytest.approx(0.001)


def test_a_normal_poke_pushes_straight_back(results: dict[str, tisim.Result]) -> None:
    for name in ("normal", "slippery", "hemisphere"):
        force = results[name].rod_force[-1]
        assert force[2] > 0
        assert np.abs(force[:2]).max() < 0.01 * force[2]


def test_friction_holds_the_surface(results: dict[str, tisim.Result]) -> None:
    """Without friction the surface slides along the tilted indenter's edge, and the force is smaller."""
    stick, slide = results["tilted"].rod_force[-1], results["tilted slippery"].rod_force[-1]
    assert np.linalg.norm(slide) < 0.98 * np.linalg.norm(stick)
    assert np.linalg.norm(slide - stick) > 0.03 * np.linalg.norm(stick)


def test_depth_counts_from_first_touch() -> None:
    """The lowest point of a sampled indenter lies on the surface, for random tilts."""
    rng = np.random.default_rng(1)
    rod = tisim.Rod()
    for _ in range(20):
        tilt, turn = rng.uniform(0, np.pi / 4), rng.uniform(0, 2 * np.pi)
        axis = np.array([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), -np.cos(tilt)])
        tip = plane_contact(rod, (0.01, -0.02), 0.032, axis)
        across = np.cross(axis, [0.0, 1.0, 0.0])
        across /= np.linalg.norm(across)
        around = np.cross(axis, across)
        phi, edge = np.meshgrid(np.linspace(0, 2 * np.pi, 721), np.linspace(0, np.pi / 2, 361))
        r = rod.radius - rod.edge_radius * (1 - np.sin(edge))
        s = -rod.edge_radius * (1 - np.cos(edge))
        ring = np.cos(phi)[..., None] * across + np.sin(phi)[..., None] * around
        points = tip + s[..., None] * axis + r[..., None] * ring
        assert points[..., 2].min() == pytest.approx(0.032, abs=1e-7)
        # the axis meets the surface at the contact point
        meets = tip + axis * (0.032 - tip[2]) / axis[2]
        assert meets[:2] == pytest.approx([0.01, -0.02], abs=1e-12)


def test_a_poke_that_cannot_go_on_says_so() -> None:
    """An indentation through a thin block and its base stops with a status, its frames and a message."""
    result = solve_poke(poke(block=tisim.Block(size=(0.03, 0.03, 0.006)), depth=0.0065, element="hex8"))
    assert not result.ok
    assert 0.001 <= result.load[-1] < 0.0062
    assert (result.min_jacobian > 0).all()
    force = np.linalg.norm(result.rod_force[-1])
    reached = (
        f"{result.load[-1] * 1e3:.2f} mm, {force:.3g} N and smallest det F {result.min_jacobian[-1]:.3f}"
    )
    left = f"{6.0 - result.load[-1] * 1e3:.1f} mm of tissue left between the rod and the base"
    assert result.message.endswith(f"after {reached}; {left} (6.0 at first touch)")


def test_tissue_squeezed_to_a_tenth_bears_the_rod() -> None:
    """Under the edge the pressure exceeds what the contact can carry, so its stiffness is raised in time."""
    ogden = tisim.material_from_moduli("ogden", shear_modulus=SHEAR, bulk_modulus=BULK)
    thin = tisim.Block(size=(0.06, 0.06, 0.012))
    result = solve_poke(poke(material=ogden, block=thin, depth=0.0108, frame_spacing=1.8e-3))
    assert result.ok, result.message


@pytest.mark.slow
def test_a_poke_leaves_two_of_32_millimetres() -> None:
    """A linear penalty, or three contact points per side, ends at 27 mm (studies/depth)."""
    ogden = tisim.material_from_moduli("ogden", shear_modulus=SHEAR, bulk_modulus=BULK)
    result = solve_poke(poke(material=ogden, depth=0.03, frame_spacing=1e-3, refinement=1.0))
    assert result.ok, result.message
    assert result.load[-1] == pytest.approx(0.03)
    assert (result.min_jacobian > 0.0).all()


@pytest.mark.slow
def test_tissue_that_slides_out_without_friction_comes_to_rest() -> None:
    """At 7 mm it slides for some 300 iterations of the damped motion (studies/depth)."""
    nearly_incompressible = tisim.material_from_moduli(
        "neo-hookean", shear_modulus=SHEAR, bulk_modulus=300.0 * SHEAR
    )
    result = solve_poke(
        poke(material=nearly_incompressible, friction=0.0, depth=0.01, frame_spacing=1e-3, refinement=1.0)
    )
    assert result.ok, result.message


def test_axisymmetric_reference() -> None:
    """Force at 1, 2, 5 and 10 mm within 1.5 % of axisymmetric quadratic elements (FElupe)."""
    forces = {int(d): v["force"] for d, v in REFERENCE["values"]["0.6"].items()}
    down = tisim.Course(frames=(1.0, 2.0, 5.0, 10.0)).ramp(to=0.010, duration=10.0)
    result = solve_poke(poke(course=down, refinement=0.9))
    assert result.ok
    found = dict(zip((result.load * 1e3).round().astype(int), result.rod_force[:, 2], strict=True))
    errors = {d: found[d] / f - 1.0 for d, f in forces.items()}
    assert set(errors) == {1, 2, 5, 10}
    assert max(map(abs, errors.values())) < 0.015, errors


def _deep_block(**changes: object) -> tisim.Result:
    """Frictionless indentation of a block that is large enough to be a half space to 2 %."""
    return solve_poke(poke(block=tisim.Block(size=(0.3, 0.3, 0.15)), friction=0.0, refinement=1.0, **changes))


def _half_space_force(rod: tisim.Rod, depth: float) -> float:
    """Force [N] on a frictionless half space (Galin, Sneddon) under a flat punch with a circular edge.

    F = 2 E* int f' r^2 / sqrt(a^2 - r^2) dr and d = int f' a / sqrt(a^2 - r^2) dr over r < a, with f the
    profile of the edge. F tends to that of the flat punch, 2 a E* d, as the edge radius decreases.
    """
    b = rod.radius - rod.edge_radius

    def over(power: int, a: float) -> float:
        def integrand(angle: float) -> float:
            r = a * np.sin(angle)
            s = max(0.0, (r - b) / rod.edge_radius)
            return float(s / np.sqrt(1 - s * s) * r**power)

        return float(quad(integrand, np.arcsin(b / a), np.pi / 2, epsabs=1e-16, epsrel=1e-7)[0])

    a = brentq(lambda a: a * over(0, a) - depth, b * (1 + 1e-9), b + 0.98 * rod.edge_radius)
    return 2 * PLANE_MODULUS * over(2, a)


@pytest.mark.slow
def test_flat_punch_at_small_depth() -> None:
    """The default mesh is too stiff by 14 %: the radial elements are as wide as the edge radius."""
    rod = tisim.Rod(edge_radius=2.5e-4)
    result = _deep_block(rod=rod, depth=1e-4, frame_spacing=5e-5)
    exact = np.array([_half_space_force(rod, float(d)) for d in result.load])
    ratio = result.rod_force[:, 2] / exact
    assert (ratio > 1.0).all()
    assert (ratio < 1.17).all()


@pytest.mark.slow
def test_hertz_for_the_hemisphere() -> None:
    """F = 4/3 E* sqrt(R) d^1.5 within 4 % at contact radii of 0.7 and 1 mm, one or two cells."""
    result = _deep_block(rod=tisim.Rod(tip="hemisphere"), depth=4e-4, frame_spacing=2e-4)
    hertz = 4 / 3 * PLANE_MODULUS * np.sqrt(0.0025) * result.load**1.5
    assert result.rod_force[:, 2] / hertz == pytest.approx(1.0, abs=0.04)
