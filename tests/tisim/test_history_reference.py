"""A block of tetrahedra in FElupe's tension and shear over time, on the same mesh and course.

4-node tetrahedra have one quadrature point and no pressure unknown: both codes solve the same equations.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import tisim
from tisim.discretisation.body import Discretisation, DiscretisedBody
from tisim.mesh import Mesh
from tisim.nonlinear.newton import newton
from tisim.problems.beam.system import BeamSystem
from tisim.result import Status

Array = NDArray[np.float64]

FILE = Path(__file__).parents[2] / "benchmarks" / "references" / "history.json"
STORED = json.loads(FILE.read_text(encoding="utf-8"))
DIGITS = 1e-9  # the file has ten digits
LAW = tisim.Material(
    law="mooney-rivlin",
    parameters={"c10": 0.5 * STORED["about"]["mu"], "c01": 0.0, "bulk": STORED["about"]["bulk"]},
)


class Block:
    """The block with a material; its driven face is displaced step by step."""

    def __init__(self, **parts: object) -> None:
        self.mesh = Mesh(
            kind="tet4",
            nodes=np.array(STORED["nodes"]),
            elements=np.array(STORED["tetrahedra"], dtype=np.int32),
        )
        self.driven = np.array(STORED["driven"])
        held = np.array(STORED["clamped"] + STORED["driven"], dtype=np.int32)
        material = tisim.Material(law=LAW.law, parameters=LAW.parameters, **parts)  # type: ignore[arg-type]
        self.body = DiscretisedBody(Discretisation.build(self.mesh, np.unique(held)), material)
        self.system = BeamSystem(self.body, tolerance=1e-11)
        self.system.least_load = 1.0  # [N]
        self.x = self.mesh.nodes.copy()
        self.at = 0.0

    def drive(self, to: float, dt: float) -> tuple[Array, Array]:
        """Displacements (n, 3) [m] and force (3,) [N] at equilibrium with the face at `to` after `dt`."""
        along = self.mesh.nodes[:, :1] / self.mesh.nodes[:, 0].max() * np.array(STORED["about"]["direction"])
        self.body.begin(dt)
        found = newton(self.system, self.x + (to - self.at) * along, tolerance=1e-11, max_iterations=20)
        assert found.status is Status.CONVERGED
        force = self.body.internal_forces(found.x)[0][self.driven].sum(axis=0)
        self.body.accept(found.x)
        self.x, self.at = found.x, to
        return found.x - self.mesh.nodes, force


def test_the_softening_block_is_felupes_in_every_frame() -> None:
    wanted = STORED["softening"]
    block = Block(softening=tisim.OgdenRoxburgh(r=wanted["r"], m=wanted["m"], beta=wanted["beta"]))
    pulls = []
    for to, displacement, force in zip(
        wanted["driven"], wanted["displacement"], wanted["force"], strict=True
    ):
        moved, pull = block.drive(to, 0.0)
        assert moved == pytest.approx(np.array(displacement), rel=DIGITS, abs=1e-12)
        assert pull == pytest.approx(force, rel=DIGITS, abs=1e-9)
        pulls.append(pull[0])
    assert wanted["driven"][1] == wanted["driven"][3]
    assert pulls[3] < 0.8 * pulls[1]


def ramps(steps: int) -> Iterator[list[tuple[float, float]]]:
    """Steps of each ramp as (length [s], displacement of the face [m]); those of a hold grow in length."""
    times, values = (0.0, *STORED["viscosity"]["time"]), (0.0, *STORED["viscosity"]["driven"])
    for (begin, before), (end, after) in pairwise(zip(times, values, strict=True)):
        part = np.linspace(0.0, 1.0, steps + 1)
        ends = part if after != before else part**3
        yield [((end - begin) * (b - a), before + (after - before) * b) for a, b in pairwise(ends.tolist())]


def course(steps: int) -> tuple[Array, Array]:
    """Displacements (4, n, 3) [m] and forces (4, 3) [N] at the ends of the ramps."""
    wanted = STORED["viscosity"]
    prony = tisim.Prony(fractions=tuple(wanted["fractions"]), times=tuple(wanted["times"]))
    block = Block(viscosity=prony)
    ends = [[block.drive(to, dt) for dt, to in ramp][-1] for ramp in ramps(steps)]
    return np.array([moved for moved, _ in ends]), np.array([force for _, force in ends])


def test_the_viscous_block_is_the_stored_one_with_steps_extrapolated_to_none() -> None:
    """The error falls with the square of the step, so that two step lengths give the limit."""
    wanted = [np.array(STORED["viscosity"][name]) for name in ("displacement", "force")]
    coarse, fine = course(6), course(12)
    for rough, better, exact in zip(coarse, fine, wanted, strict=True):
        size = np.abs(exact).max()
        assert np.abs(fine_error := better - exact).max() < 1e-3 * size
        assert np.abs(rough - exact).max() == pytest.approx(4.0 * np.abs(fine_error).max(), rel=0.2)
        assert np.abs((4.0 * better - rough) / 3.0 - exact).max() < 3e-5 * size
