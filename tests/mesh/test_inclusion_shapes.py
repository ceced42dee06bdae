"""Inclusion shapes: requirements on every registered one, and one added from outside the package."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from poke_cases import gauss_jacobians

import tisim
from tisim import Block, BoxInclusion, CylinderInclusion, Rod, SphereInclusion, inclusions
from tisim.inclusions import _registry
from tisim.mesh import poke_mesh

SHAPES = [
    BoxInclusion(size=(0.012, 0.018, 0.010), centre=(0.004, -0.006, 0.007), angle=0.7),
    SphereInclusion(radius=0.007, centre=(0.004, -0.006, 0.009)),
    CylinderInclusion(radius=0.006, height=0.012, centre=(0.004, -0.006, 0.006)),
]

OUTSIDE = '''
"""A hexagonal prism and a spheroid: two inclusion shapes of somebody else's."""

from dataclasses import dataclass

import numpy as np

from tisim import inclusions


@dataclass(frozen=True, kw_only=True)
class Hexagon(inclusions.Inclusion):
    kind = "hexagon"
    angles = ("angle",)

    side: float
    height: float
    angle: float = 0.0

    def mesh_geometry(self):
        turn = self.angle + np.pi / 3 * np.arange(6)
        corners = np.column_stack([np.cos(turn), np.sin(turn)]) * self.side + np.array(self.centre[:2])
        z = self.centre[2]
        return inclusions.Prism.polygon(
            corners, centre=self.centre, low=z - self.height / 2, high=z + self.height / 2
        )

    def signed_distance(self, points):
        local = np.asarray(points) - self.centre
        turn = self.angle + np.pi / 6 + np.pi / 3 * np.arange(6)
        across = local[..., :2] @ np.stack([np.cos(turn), np.sin(turn)])
        beside = across.max(axis=-1) - self.side * np.sqrt(3) / 2
        above = np.abs(local[..., 2]) - self.height / 2
        outside = np.hypot(np.maximum(beside, 0), np.maximum(above, 0))
        return outside + np.minimum(np.maximum(beside, above), 0)

    @property
    def extent(self):
        corners = self.mesh_geometry().corners - np.array(self.centre[:2])
        return (*(float(v) for v in np.abs(corners).max(axis=0)), self.height / 2)

    @property
    def volume(self):
        return 1.5 * np.sqrt(3) * self.side**2 * self.height


@dataclass(frozen=True, kw_only=True)
class SpheroidInclusion(inclusions.Inclusion):
    kind = "spheroid"

    radius: float
    half_height: float

    def mesh_geometry(self):
        return inclusions.Spheroid(radius=self.radius, half_height=self.half_height)

    def signed_distance(self, points):
        half = np.array([self.radius, self.radius, self.half_height])
        return (np.linalg.norm((np.asarray(points) - self.centre) / half, axis=-1) - 1) * half.min()

    @property
    def extent(self):
        return (self.radius, self.radius, self.half_height)

    @property
    def volume(self):
        return 4 / 3 * np.pi * self.radius**2 * self.half_height


inclusions.register(
    Hexagon,
    recipe=inclusions.RecipeShape(
        name="hexagon",
        parameters=(inclusions.RecipeParameter("side"), inclusions.RecipeParameter("height")),
        standing=lambda p, x, y, angle: Hexagon(
            side=p["side"], height=p["height"], centre=(x, y, p["height"] / 2), angle=angle
        ),
        turned=True,
    ),
)
inclusions.register(SpheroidInclusion)
'''


@pytest.fixture(scope="module")
def outside(tmp_path_factory: pytest.TempPathFactory):
    """The module with the added shapes, as a user's own file."""
    folder = tmp_path_factory.mktemp("outside")
    (folder / "my_shapes.py").write_text(OUTSIDE)
    sys.path.insert(0, str(folder))
    before = dict(_registry._SHAPES), dict(_registry._RECIPES), dict(_registry._RECIPE_OF)
    try:
        import my_shapes

        yield my_shapes
    finally:
        sys.path.remove(str(folder))
        del sys.modules["my_shapes"]
        for known, then in zip(
            (_registry._SHAPES, _registry._RECIPES, _registry._RECIPE_OF), before, strict=True
        ):
            known.clear()
            known.update(then)


@pytest.fixture(params=["box", "sphere", "cylinder", "hexagon", "spheroid"])
def shape(request: pytest.FixtureRequest, outside):
    added = {
        "hexagon": outside.Hexagon(side=0.007, height=0.010, centre=(0.004, -0.006, 0.005), angle=0.3),
        "spheroid": outside.SpheroidInclusion(radius=0.009, half_height=0.006, centre=(0.0, 0.0, 0.012)),
    }
    return {s.kind: s for s in SHAPES}.get(request.param) or added[request.param]


def samples(shape: inclusions.Inclusion, count: int = 200_000) -> tuple[np.ndarray, float]:
    """Random points in a box slightly larger than the shape's bounds, and the volume of the box."""
    low, high = (np.array(b) for b in shape.bounds)
    room = 0.1 * (high - low)
    size = high - low + 2 * room
    return low - room + np.random.default_rng(0).random((count, 3)) * size, float(np.prod(size))


def test_volume_inside_and_bounds_agree(shape) -> None:
    points, box = samples(shape)
    inside = shape.contains(points)
    assert np.array_equal(inside, shape.signed_distance(points) <= 0.0)
    assert box * inside.mean() == pytest.approx(shape.volume, rel=0.01)
    low, high = shape.bounds
    assert points[inside].min(axis=0) == pytest.approx(low, abs=3e-4)
    assert points[inside].max(axis=0) == pytest.approx(high, abs=3e-4)
    assert ((points[inside] >= low) & (points[inside] <= high)).all()


@pytest.mark.parametrize("exact", SHAPES, ids=lambda s: s.kind)
def test_distances_of_the_built_in_shapes_are_distances(exact) -> None:
    """The gradient of the signed distance has norm 1."""
    points, _ = samples(exact, 2000)
    step = 1e-7
    slope = np.stack(
        [
            (exact.signed_distance(points + d) - exact.signed_distance(points - d)) / (2 * step)
            for d in step * np.eye(3)
        ],
        axis=-1,
    )
    size = np.linalg.norm(slope, axis=-1)
    assert np.mean(np.abs(size - 1.0) < 1e-6) > 0.99  # except on the medial axis


def test_plain_form_and_dimensions_give_the_shape_back(shape) -> None:
    assert inclusions.decode(shape.encode()) == shape
    angle = getattr(shape, "angle", 0.0)
    assert inclusions.from_dimensions(shape.kind, (*shape.dimensions, 0.0), shape.centre, angle) == shape


def test_a_shape_in_millimetres_is_the_shape(shape) -> None:
    small = shape.scaled(1e3).scaled(1e-3)
    assert small.volume == pytest.approx(shape.volume, rel=1e-12)
    assert small.centre == pytest.approx(shape.centre, rel=1e-12)
    assert getattr(small, "angle", None) == getattr(shape, "angle", None)


def test_a_block_lacks_the_shape(shape) -> None:
    block = Block(inclusion=shape)
    mesh = poke_mesh(block=block, site=(0.0, 0.0), rod=Rod())
    determinants = gauss_jacobians(mesh)
    assert determinants.min() > 0
    rigid = float(np.prod(block.size)) - determinants.sum()
    low = shape.bounds[0][2]
    assert low >= 0.0, "all of it counts"
    tolerance = {"box": 1e-9, "hexagon": 1e-9}.get(shape.kind, 0.2)
    assert rigid == pytest.approx(shape.volume, rel=tolerance)
    # a mid-side node stays on its chord if the curve would invert an element
    held = mesh.nodes[np.intersect1d(mesh.node_sets["base"], mesh.elements[:, :8])]
    held = held[held[:, 2] > 1e-9]
    if shape.kind != "spheroid":  # its signed distance is exact on the surface only
        assert np.abs(shape.signed_distance(held)).max() < 1e-9
    else:
        on = np.linalg.norm((held - shape.centre) / shape.extent, axis=1)
        assert np.abs(on - 1.0).max() < 1e-6


def test_plans_are_the_meshed_outlines(shape) -> None:
    plan = shape.plan(400)
    after = np.roll(plan, -1, axis=0)
    area = 0.5 * float((plan[:, 0] * after[:, 1] - plan[:, 1] * after[:, 0]).sum())
    middle = np.column_stack([plan, np.full(len(plan), shape.centre[2])])
    assert np.abs(shape.signed_distance(middle)).max() < 1e-9
    assert area > 0


@pytest.mark.usefixtures("outside")
@pytest.mark.parametrize("name", ["cube", "sphere", "cylinder", "hexagon"])
def test_recipes_stand_their_shapes_on_the_base(name: str) -> None:
    recipe = inclusions.recipe_shapes()[name]
    given = {p.name: 8.0 if p.default is None else p.default for p in recipe.parameters}
    made = recipe.standing(given, 3.0, -2.0, 0.4)
    assert made.bounds[0][2] == pytest.approx(0.0)
    assert made.bounds[1][2] == pytest.approx(recipe.top_of(given))
    assert made.centre[:2] == (3.0, -2.0)
    plan = made.plan() - np.array(made.centre[:2])
    assert np.linalg.norm(plan, axis=1).max() == pytest.approx(recipe.reach_of(given))
    turned = recipe.standing(given, 3.0, -2.0, 0.0) != made
    assert turned == recipe.turned
    made.scaled(1e-3).check()


def test_a_poke_meets_a_shape_added_by_another_process_s_file(tmp_path: Path) -> None:
    """With the user's file only, and in two worker processes."""
    (tmp_path / "my_shapes.py").write_text(OUTSIDE)
    script = tmp_path / "run.py"
    script.write_text(
        "import tisim\n"
        "from my_shapes import Hexagon\n"
        "soft = tisim.material_from_moduli('neo-hookean', shear_modulus=1e4, bulk_modulus=1e6)\n"
        "def poke(side):\n"
        "    body = Hexagon(side=side, height=0.012, centre=(0.0, 0.0, 0.006))\n"
        "    block = tisim.Block(inclusion=body)\n"
        "    return tisim.Poke(material=soft, depth=5e-4, block=block, refinement=0.5)\n"
        "if __name__ == '__main__':\n"
        "    results = tisim.simulate([poke(0.006), poke(0.008)], workers=2)\n"
        "    soft, stiff = (r.rod_force[-1, 2] for r in results)\n"
        "    print([r.status.value for r in results], soft < stiff)\n"
    )
    path = os.pathsep.join([str(Path(tisim.__file__).parents[1]), str(tmp_path)])
    done = subprocess.run(
        [sys.executable, str(script)],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.strip() == "['converged', 'converged'] True", done.stderr


@dataclass(frozen=True, kw_only=True)
class Ball(SphereInclusion):
    """A class with the sphere's kind."""


@dataclass(frozen=True, kw_only=True)
class Nowhere(SphereInclusion):
    kind = "nowhere"
    angles = ("tilt",)


def test_what_is_no_shape_is_refused() -> None:
    with pytest.raises(ValueError, match=r"tisim.inclusions.sphere.SphereInclusion is the shape 'sphere'"):
        inclusions.register(Ball)
    with pytest.raises(TypeError, match="expected a frozen dataclass that derives from Inclusion"):
        inclusions.register(Path)  # type: ignore[type-var]
    with pytest.raises(TypeError, match="each of `angles` as a field"):
        inclusions.register(Nowhere)
    cube = inclusions.recipe_shapes()["cube"]
    with pytest.raises(ValueError, match="another shape's recipe is called 'cube'"):
        inclusions.register(SphereInclusion, recipe=cube)
    assert inclusions.register(SphereInclusion) is SphereInclusion  # a module imported again
    assert inclusions.kinds()[:3] == ("box", "sphere", "cylinder")


@pytest.mark.parametrize(
    ("plain", "words"),
    [
        ({"kind": "torus"}, "expected one of box, sphere, cylinder"),
        ({"kind": "sphere", "radius": 0.01}, "inclusion sphere: expected centre, radius"),
        ({"kind": "sphere", "radius": "wide", "centre": [0, 0, 0]}, "expected numbers"),
        ({"kind": "sphere", "radius": -1.0, "centre": [0, 0, 0]}, "radius: expected a length above 0"),
    ],
)
def test_a_damaged_plain_form_is_refused(plain, words) -> None:
    with pytest.raises(ValueError, match=words):
        inclusions.decode(plain)


def test_too_few_dimensions_are_refused() -> None:
    with pytest.raises(ValueError, match="too few dimensions"):
        inclusions.from_dimensions("cylinder", [0.01], (0.0, 0.0, 0.0))


def test_a_field_that_cannot_be_is_named() -> None:
    with pytest.raises(ValueError, match="size: expected a length above 0"):
        replace(SHAPES[0], size=(0.01, 0.0, 0.01)).check()
    with pytest.raises(ValueError, match="angle: expected an angle in radians"):
        replace(SHAPES[0], angle=float("nan")).check()
