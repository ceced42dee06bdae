"""A type of scene registered from outside the package: checked, solved in any process, described."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from other_process import python

import tisim
from tisim import problems

SQUEEZE = '''
"""A free cube under one volume ratio after the other: a kind of scene of somebody else's."""

from dataclasses import dataclass, field

import numpy as np

import tisim
from tisim import problems


@dataclass(frozen=True, kw_only=True)
class Squeeze:
    material: tisim.Material
    ratios: tuple[float, ...] = (0.99, 0.95)
    solver: tisim.Solver = field(default_factory=tisim.Solver)


def check(scene):
    if not all(0.0 < r for r in scene.ratios):
        raise ValueError(f"ratios: expected numbers above 0, got {scene.ratios}")


def solve(scene, on_step):
    mesh = tisim.mesh.beam_mesh(length=1.0, section=tisim.Rectangle(width=1.0, height=1.0))
    F = np.cbrt(scene.ratios)[:, None, None] * np.eye(3)
    _, stress, _ = tisim.laws.evaluate(scene.material.law, scene.material.parameters, F)
    on_step(0.5)
    return tisim.Result(
        scene=scene,
        status=tisim.Status.CONVERGED,
        mesh=mesh,
        load=np.array(scene.ratios),
        positions=F[:, 0, 0, None, None] * mesh.nodes,
        support_force=np.zeros((len(F), 3)),
        min_jacobian=np.array(scene.ratios),
        residual=np.zeros(len(F)),
        nominal_stress=stress[:, 0, 0],
    )


problems.register(
    problems.SceneKind(
        scene=Squeeze,
        check=check,
        solve=solve,
        seconds=lambda scene: 0.01 * len(scene.ratios),
        mesh_key=lambda scene: ("cube",),
        describe=lambda result, frame: f"Cube at {result.load[frame]:g} of its volume",
    )
)
'''
MAIN = """
import sys

import tisim
from my_squeeze import Squeeze

if __name__ == "__main__":
    soft = tisim.material_from_moduli("neo-hookean", shear_modulus=1e4, bulk_modulus=1e6)
    # two chains, so that each process takes one; another scene would have to load the kernels of elements
    scenes = [Squeeze(material=soft, ratios=(0.99, 0.9 - 0.01 * k)) for k in range(9)]
    print([found.nominal_stress.tolist() for found in tisim.simulate(scenes, workers=2)])
    print("taichi" not in sys.modules)
"""
SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=1e4, bulk_modulus=1e6)


@pytest.fixture
def squeeze(tmp_path: Path) -> Iterator[ModuleType]:
    (tmp_path / "my_squeeze.py").write_text(SQUEEZE)
    sys.path.insert(0, str(tmp_path))
    try:
        import my_squeeze

        yield my_squeeze
        problems.unregister(my_squeeze.Squeeze)
    finally:
        sys.path.remove(str(tmp_path))
        sys.modules.pop("my_squeeze", None)


def test_an_added_kind_is_solved_checked_and_described(squeeze: ModuleType, tmp_path: Path) -> None:
    seen: list[float] = []
    scenes = [squeeze.Squeeze(material=SOFT), tisim.Coupon(material=SOFT, stretches=(1.1,))]
    cube, _ = tisim.simulate(scenes, workers=1, on_progress=lambda done, _: seen.append(done))
    assert cube.ok
    assert cube.nominal_stress[0] > cube.nominal_stress[1]
    assert any(d % 1.0 > 0.0 for d in seen)
    assert tisim.picture(cube, tmp_path / "cube.png").stat().st_size > 1000
    from tisim.io.picture import describe

    assert describe(cube).startswith("Cube at 0.95 of its volume; Neo-Hookean")
    with pytest.raises(ValueError, match=r"scene 1: Squeeze.ratios: expected numbers above 0, got \(-1.0,\)"):
        tisim.simulate([scenes[1], squeeze.Squeeze(material=SOFT, ratios=(-1.0,))])
    with pytest.raises(ValueError, match=r"scene 0: Squeeze.solver.tolerance"):
        tisim.simulate(squeeze.Squeeze(material=SOFT, solver=tisim.Solver(tolerance=2.0)))


def test_other_processes_solve_an_added_kind(squeeze: ModuleType, tmp_path: Path) -> None:
    """The same numbers as in this process; the one that starts the others solves none itself."""
    (tmp_path / "run.py").write_text(MAIN)
    there, left = python(tmp_path, str(tmp_path / "run.py")).splitlines()
    assert left == "True"
    scenes = [squeeze.Squeeze(material=SOFT, ratios=(0.99, 0.9 - 0.01 * k)) for k in range(9)]
    here = [found.nominal_stress.tolist() for found in tisim.simulate(scenes, workers=1)]
    assert json.loads(there) == here


@dataclass(frozen=True, kw_only=True)
class Unknown:
    material: tisim.Material
    solver: tisim.Solver = field(default_factory=tisim.Solver)


def test_what_is_no_kind_is_refused() -> None:
    with pytest.raises(TypeError, match="expected a SceneKind whose scene is a dataclass"):
        problems.register(Unknown)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="expected a SceneKind whose scene is a dataclass"):
        problems.register(problems.SceneKind(scene=int, solve=lambda s, _: s))
    with pytest.raises(ValueError, match="Beam is a kind of tisim's own"):
        problems.register(problems.SceneKind(scene=tisim.Beam, solve=lambda s, _: s))
    with pytest.raises(ValueError, match="scene 0: expected a Beam, Poke, Coupon or Press, got Unknown"):
        tisim.simulate(Unknown(material=SOFT))  # type: ignore[call-overload]
    assert np.size(problems.kind_of(tisim.Coupon(material=SOFT)).mesh_key(None)) == 1
