"""The beam that goes with a card: mesh, what is held, loads; and what the target's elements make of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment, beam_as_stated
from calibration.export._form_law import law_of
from calibration.export._forms import Form
from tisim import Beam, Circle, Material, Result, simulate
from tisim.discretisation.quadrature import reference
from tisim.mesh import Mesh, beam_mesh, volumes

Array = NDArray[np.float64]

# The paper's cantilever of 100 mm.
PAPER_LENGTH, PAPER_RADIUS = 0.100, 0.010
# Mean length of elements along the beam [m], and elements from axis to surface, at refinement 1.
SIZES: Mapping[str, tuple[float, int]] = {"tet10": (0.007, 2), "tet4": (0.0035, 4)}
# Part of the beam's volume at each end of the range of stretches that does not count: clamps' corners.
TAIL = 0.005


@dataclass(frozen=True, eq=False, kw_only=True)
class BeamScene:
    """A beam for another program, SI.

    Attributes
    ----------
    name : str
        In words.
    beam : Beam
        The scene in tisim, of the card's material without memory.
    mesh : Mesh
        Whole beam, elements of the target's kind.
    held : ndarray of int
        Nodes that are fixed.
    watched : ndarray of int
        Nodes whose mean displacement is compared: the free end, or the middle between two clamps.
    forces : ndarray, shape (n, 3)
        Nodal forces besides gravity [N].
    refinement : float
        How much finer than usual the mesh is.
    """

    name: str
    beam: Beam
    mesh: Mesh
    held: NDArray[np.int32]
    watched: NDArray[np.int32]
    forces: Array
    refinement: float = 1.0

    @property
    def loaded(self) -> bool:
        """True if there is a tip force."""
        return bool(np.any(self.forces))

    @property
    def loaded_nodes(self) -> NDArray[np.intp]:
        """Indices of the nodes with a tip force."""
        return np.flatnonzero(np.any(self.forces != 0.0, axis=1))

    @property
    def mass(self) -> Array:
        """Mass at each node, a fourth of each of its elements (tet4) [kg], (n,)."""
        found = np.zeros(self.mesh.n_nodes)
        each = volumes(self.mesh) * self.beam.material.density / self.mesh.elements.shape[1]
        np.add.at(found, self.mesh.elements, each[:, None])
        return found

    def moved(self, positions: Array) -> Array:
        """Mean displacement of the watched nodes [m], (3,)."""
        return np.asarray((positions - self.mesh.nodes)[self.watched].mean(axis=0))


@dataclass(frozen=True, eq=False, kw_only=True)
class Prediction:
    """The beam by tisim, and the result expected of the target.

    Attributes
    ----------
    reference : ndarray, shape (3,)
        Mean displacement of the watched nodes with the card's law, without the error of a coarse mesh [m].
    expected : ndarray, shape (3,) or None
        The same with the target's law and elements on the exported mesh; None where tisim cannot say.
    error : float
        How far the target may be from `reference`, a fraction of its size.
    elements : float or None
        Of linear tetrahedra: how much further (above 0) or less far the beam moves by them alone, a fraction.
    low, high : float
        Principal stretches in the beam, but for the outermost of its volume (TAIL).
    remarks : tuple of str
        What of it could not be found.
    """

    reference: Array
    expected: Array | None
    error: float
    low: float
    high: float
    elements: float | None = None
    remarks: tuple[str, ...] = field(default=())


def scene_of(
    material: Material,
    element: str,
    *,
    experiment: Experiment | None = None,
    trial: str | None = None,
    refinement: float = 1.0,
    material_name: str = "",
) -> tuple[BeamScene, tuple[str, ...]]:
    """The beam of an experiment's trial, or the paper's; and remarks.

    InputError for a trial that is not there or is no beam.
    """
    remarks: tuple[str, ...] = ()
    chosen = None
    if experiment is not None:
        trials = [t for t in experiment.trials if isinstance(t, BeamTrial)]
        beams = [t for t in trials if material_name in ("", t.material)]
        if trial is not None:
            chosen = next((t for t in beams if t.id == trial), None)
            if chosen is None:
                known = ", ".join(t.id for t in beams) or "none"
                raise InputError(f"--trial {trial}: expected a beam of that material: {known}")
        elif beams:
            chosen = beams[0]
        else:
            remarks = (f"{experiment.name!r} has no beam of this material: the scene is the paper's beam",)
    elif trial is not None:
        raise InputError(f"--trial {trial}: expected --experiment beside it")
    if chosen is None:
        beam, name = Beam(material=material, length=PAPER_LENGTH, section=Circle(radius=PAPER_RADIUS)), ""
        name = "the paper's beam: a cylinder of 10 mm radius, 100 mm free of its clamp, under its weight"
    else:
        if chosen.tip_force_height:
            remarks += ("the tip force acts at the middle of the end face, not above its axis as measured",)
        beam = beam_as_stated(chosen, material)
        name = f"trial {chosen.id} of experiment {experiment.name!r}"  # type: ignore[union-attr]
    size, rings = SIZES[element]
    mesh = beam_mesh(
        length=beam.length, section=beam.section, supports=beam.supports, kind=element,  # type: ignore[arg-type]
        axial_element_size=size / refinement, radial_elements=max(1, round(rings * refinement)),
    )  # fmt: skip
    held = np.unique(
        np.concatenate([mesh.node_sets[s] for s in ("clamp", "far_clamp") if s in mesh.node_sets])
    )
    watched = mesh.node_sets.get("tip")
    if watched is None:
        x = np.unique(np.round(mesh.nodes[:, 0], 12))
        middle = x[np.abs(x - 0.5 * beam.length).argmin()]
        watched = np.flatnonzero(np.abs(mesh.nodes[:, 0] - middle) < 1e-9).astype(np.int32)
    scene = BeamScene(
        name=name, beam=beam, mesh=mesh, held=held, watched=watched, forces=_tip_forces(mesh, beam),
        refinement=refinement,
    )  # fmt: skip
    return scene, remarks


def _tip_forces(mesh: Mesh, beam: Beam) -> Array:
    """The tip force as an even traction over the end face, in nodal forces."""
    forces = np.zeros((mesh.n_nodes, 3))
    if not any(beam.tip_force):
        return forces
    facets = mesh.facet_sets["tip"]
    corner = mesh.nodes[facets[:, :3]]
    area = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    share = area / area.sum() / 3.0
    # on a straight triangle a quadratic traction's corners carry nothing, the middles of edges a third each
    nodes = facets[:, 3:] if facets.shape[1] == 6 else facets
    np.add.at(forces, nodes, share[:, None, None] * np.asarray(beam.tip_force))
    return forces


@dataclass(frozen=True, eq=False, kw_only=True)
class Reference:
    """The beam in tisim, with the card's law: displacement of the watched nodes [m], principal stretches."""

    moved: Array
    low: float
    high: float


def solve(scene: BeamScene) -> Reference:
    """The beam as it is. InputError where it has no equilibrium."""
    plain = scene.beam
    results = simulate([plain, replace(plain, axial_element_size=0.004, radial_elements=3)], workers=1)
    if not all(r.ok for r in results):
        raise InputError(
            f"the beam of {scene.name} has no equilibrium with this card in tisim itself"
            f" ({results[0].message or results[1].message}): export it without a scene (--no-scene)"
        )
    low, high = _stretches(results[0])
    return Reference(moved=_end(results[1], plain), low=low, high=high)


def predict(
    scene: BeamScene, found: Reference, form: Form, *, replaced: bool, element_error: float
) -> Prediction:
    """Result expected of the target for the beam, by tisim.

    Parameters
    ----------
    scene : BeamScene
    found : Reference
        The beam with the card's law.
    form : Form
        What the target is given.
    replaced : bool
        The form is another law than the card's, and not only by its volumetric part.
    element_error : float
        How far a target's quadratic elements may be from tisim's on the same mesh, a fraction.
    """
    plain, scenes = scene.beam, []
    quadratic = scene.mesh.kind == "tet10"
    with law_of(form, any_volume=quadratic) as law:
        if quadratic and not replaced:
            scenes.append(replace(plain, mesh=scene.mesh))
        elif law is not None:
            other = replace(plain, material=replace(plain.material, law=law[0], parameters=law[1]))
            scenes.append(replace(other, mesh=scene.mesh, element=scene.mesh.kind))
            scenes += [] if quadratic else [other]
        results = simulate(scenes, workers=1)
    expected, elements, error, remarks = None, None, np.nan, []
    if results and results[0].ok:
        expected = scene.moved(results[0].positions[-1])
        error = float(np.linalg.norm(expected - found.moved) / np.linalg.norm(found.moved))
        error += element_error if quadratic else 0.0
    elif results:
        remarks.append(
            "with the target's law and elements tisim finds no equilibrium of this beam"
            f" ({results[0].message})"
        )
    if expected is not None and len(results) > 1 and results[1].ok:
        elements = float(np.linalg.norm(expected) / np.linalg.norm(_end(results[1], plain)) - 1.0)
    return Prediction(
        reference=found.moved,
        expected=expected,
        error=error,
        low=found.low,
        high=found.high,
        elements=elements,
        remarks=tuple(remarks),
    )


def _end(result: Result, beam: Beam) -> Array:
    """Mean displacement of the free end (or of the middle) of a result on its own mesh."""
    nodes = result.mesh.nodes
    at = beam.length if "tip" in result.mesh.node_sets else 0.5 * beam.length
    x = nodes[:, 0]
    place = x[np.abs(x - at).argmin()]
    plane = np.abs(x - place) < 1e-9
    moved = (result.positions[-1] - nodes)[plane]
    found = moved.mean(axis=0)
    if "y" in result.mesh.symmetry:
        found[1] = 0.0
    return np.asarray(found)


def _stretches(result: Result) -> tuple[float, float]:
    """Least and largest principal stretch in the body, but for TAIL of its volume at either end."""
    ref = reference(result.mesh)
    F = np.einsum("eqak,eai->eqik", ref.gradients, result.positions[-1][result.mesh.elements])
    stretches = np.linalg.svd(F, compute_uv=False).reshape(-1, 3)
    weights = ref.weights.ravel()
    found = []
    for values, tail in ((stretches[:, 2], TAIL), (stretches[:, 0], 1.0 - TAIL)):
        order = np.argsort(values)
        found.append(float(values[order][np.searchsorted(np.cumsum(weights[order]), tail * weights.sum())]))
    return found[0], found[1]
