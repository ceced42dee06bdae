"""Beams, modes and closed forms shared by the tests of the dynamic methods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh

from tisim.bodies import Circle
from tisim.discretisation.body import Discretisation, DiscretisedBody
from tisim.discretisation.mass import consistent_mass, lumped_mass
from tisim.material import Material
from tisim.problems.beam.system import beam_discretisation, beam_system
from tisim.problems.dynamics import explicit, implicit
from tisim.scene import Beam, Solver

MU, LAM, DENSITY = 40e3, 800e3, 1000.0
SOFT = Material(law="neo-hookean", parameters={"mu": MU, "lam": LAM}, density=DENSITY)
SHORT = Beam(material=SOFT, length=0.03, axial_element_size=0.01, radial_elements=1)
SLENDER = Beam(material=SOFT, length=0.1, section=Circle(radius=0.005))
MARCH = {"implicit": implicit.march, "explicit": explicit.march}


def body_of(scene: Beam, *, loaded: bool = True) -> DiscretisedBody:
    body = beam_system(scene, beam_discretisation(scene)).body
    return body if loaded else DiscretisedBody(body.discretisation, scene.material)


def free_body(scene: Beam) -> DiscretisedBody:
    """The beam's mesh without fixed nodes and without load."""
    return DiscretisedBody(
        Discretisation.build(beam_discretisation(scene).mesh, np.zeros(0, dtype=np.int32)), scene.material
    )


def tip(mesh, x):
    """Mean displacement (3,) [m] of the end face's nodes."""
    nodes = mesh.node_sets["tip"]
    return (x[nodes] - mesh.nodes[nodes]).mean(axis=0)


@dataclass(frozen=True)
class Mode:
    """First bending mode of the discrete body.

    Attributes
    ----------
    shape : ndarray (n, 3)
        Mode shape with largest entry 1.
    w : float
        Angular frequency [rad/s].
    mass : csr_matrix (n, n)
        Mass matrix of one displacement component.
    """

    shape: np.ndarray
    w: float
    mass: sparse.csr_matrix

    def amplitude(self, mesh, x) -> float:
        """Mass-weighted projection of a displacement on the mode."""
        weight = self.mass @ self.shape
        return float(np.vdot(weight, x - mesh.nodes) / np.vdot(weight, self.shape))


def first_mode(body: DiscretisedBody, *, lumped: bool) -> Mode:
    """Compute the first mode from the tangent stiffness at rest; `lumped`: with the lumped mass."""
    discretisation = body.discretisation
    mesh, p = discretisation.mesh, discretisation.pattern
    blocks = body.stiffness(mesh.nodes)[0]
    discretisation.hold(blocks)
    size = 3 * len(p.free)
    upper = sparse.triu(sparse.bsr_matrix((blocks, p.indices, p.indptr), shape=(size, size)))
    stiffness = sparse.csc_matrix(upper + sparse.triu(upper, 1).T)
    if lumped:
        mass = sparse.csr_matrix(sparse.diags_array(lumped_mass(mesh, DENSITY)))
    else:
        mass = consistent_mass(mesh, DENSITY)
    full = sparse.csc_matrix(sparse.kron(mass[p.free][:, p.free], np.eye(3)))
    start = np.ones(size)
    values, vectors = eigsh(stiffness, k=1, M=full, sigma=0.0, v0=start)
    shape = np.zeros_like(mesh.nodes)
    shape[p.free] = vectors[:, 0].reshape(-1, 3)
    shape /= shape.ravel()[np.argmax(np.abs(shape))]
    return Mode(shape, float(np.sqrt(values[0])), mass)


def timoshenko_frequency(length: float, radius: float) -> tuple[float, float]:
    """First angular frequencies [rad/s] of a round cantilever by Euler-Bernoulli and by Timoshenko.

    Dunkerley's sum 1/w^2 = (1 + 4.648 r^2/L^2)/w_b^2 + 1/w_s^2 with w_s = pi/(2 L) sqrt(k G/rho) of the
    shear cantilever; Cowper's k = 6 (1 + nu)/(7 + 6 nu) of the circle; r^2 = R^2/4. 4.648/L^2 is the
    ratio of the integrals of w'^2 and w^2 over the mode.
    """
    bulk = LAM + 2.0 * MU / 3.0
    young = 9.0 * bulk * MU / (3.0 * bulk + MU)
    nu = young / (2.0 * MU) - 1.0
    r2 = radius**2 / 4.0
    bending = 1.8751041**2 * np.sqrt(young * r2 / (DENSITY * length**4))
    factor = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu)
    shear = np.pi / (2.0 * length) * np.sqrt(factor * MU / DENSITY)
    return float(bending), float(1.0 / np.sqrt((1.0 + 4.648 * r2 / length**2) / bending**2 + 1.0 / shear**2))


def swing(
    method: str,
    body: DiscretisedBody,
    mode: Mode,
    *,
    periods: float,
    steps: int,
    mass=0.0,
    stiffness=0.0,
    amplitude=1e-4,
):
    """Ratio of the modal amplitude after `periods` damped periods to that at release, `amplitude` [m]."""
    rate = 0.5 * (mass + stiffness * mode.w**2)
    damped = np.sqrt(mode.w**2 - rate**2)
    duration = periods * 2.0 * np.pi / damped
    solver = Solver(
        duration=duration,
        time_step=duration / steps,
        mass_damping=mass,
        stiffness_damping=stiffness,
        tolerance=1e-7,
    )
    mesh = body.discretisation.mesh
    run = MARCH[method](body, solver, start=mesh.nodes + amplitude * mode.shape)
    assert run.status == "converged", run.message
    assert np.isclose(run.frames.time[-1], duration, rtol=1e-12)
    return mode.amplitude(mesh, run.frames.positions[-1]) / amplitude
