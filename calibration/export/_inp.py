"""Materials and beams as Abaqus and CalculiX read them.

*HYPERELASTIC (both manuals): isochoric parts by Ibar and lbar, volumetric ones (J - 1)^2 / D with D = 2/K,
but Arruda and Boyce's, which is ((J^2 - 1)/2 - ln J) / D. Ogden's is sum 2 mu_i/alpha_i^2 (sum lbar^alpha_i -
3), so mu_i is half of mu_p alpha_p in the paper's convention. Fields of more than 20 characters are cut off:
numbers have ten digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration.export._forms import COUPLED, Form
from calibration.export._scene import BeamScene
from tisim import Material
from tisim.parts import HolzapfelGasserOgden

MOST_TERMS = 3  # of Ogden and polynomial forms, which both programs take


def writes(form: Form, material: Material) -> Form | None:  # noqa: ARG001 - one signature for all targets
    """The form with these programs' volumetric part; None for one that *HYPERELASTIC lacks."""
    if form.kind in COUPLED:
        return None
    if form.kind == "arruda-boyce":
        return replace(form, volume="square")
    if form.kind == "ogden":
        return replace(form, volume="linear") if len(form.mu) <= MOST_TERMS else None
    powers = {ij for ij, _ in form.terms}
    plain = powers <= {(1, 0), (0, 1)} or powers <= {(1, 0), (2, 0), (3, 0)}
    return replace(form, volume="linear") if plain else None


SMALLEST = 1e-6  # k2 of fibres: the programs divide by it


def has_fibres(material: Material, form: Form) -> bool:
    """The programs' fibres are those of tisim, and lie in a neo-Hookean body alone."""
    known = isinstance(material.fibres, HolzapfelGasserOgden)
    return known and form.kind == "polynomial" and [ij for ij, _ in form.terms] == [(1, 0)]


def number(x: float) -> str:
    """Ten digits, at most 17 characters."""
    return f"{x + 0.0:.10g}"


def rows(values: Sequence[float], width: int = 8) -> list[str]:
    """Data lines of so many numbers."""
    text = [number(x) for x in values]
    return [", ".join(text[k : k + width]) for k in range(0, len(text), width)]


def hyperelastic(form: Form, *, further: float, options: str = "") -> list[str]:
    """The *HYPERELASTIC block; `further`: D of all terms but the first, which has the volume's energy."""
    d = 2.0 / form.bulk
    if form.kind == "arruda-boyce":
        return [f"*HYPERELASTIC, ARRUDA-BOYCE{options}", *rows([form.mu[0], form.locking, d])]
    if form.kind == "ogden":
        n = len(form.mu)
        pairs = [x for m, a in zip(form.mu, form.alpha, strict=True) for x in (0.5 * m * a, a)]
        return [f"*HYPERELASTIC, OGDEN, N={n}{options}", *rows([*pairs, d, *[further] * (n - 1)])]
    terms = dict(form.terms)
    if set(terms) == {(1, 0)}:
        return [f"*HYPERELASTIC, NEO HOOKE{options}", *rows([terms[(1, 0)], d])]
    if (0, 1) in terms:
        constants = [terms.get((1, 0), 0.0), terms[(0, 1)], d]
        return [f"*HYPERELASTIC, MOONEY-RIVLIN{options}", *rows(constants)]
    n = max(i for i, _ in terms)
    constants = [terms.get((i, 0), 0.0) for i in range(1, n + 1)]
    return [
        f"*HYPERELASTIC, REDUCED POLYNOMIAL, N={n}{options}",
        *rows([*constants, d, *[further] * (n - 1)]),
    ]


def mesh_lines(scene: BeamScene, element: str) -> list[str]:
    """Nodes, elements and sets: CLAMP, and END (the free end, or the middle between two clamps)."""
    nodes = np.round(scene.mesh.nodes, 12) + 0.0
    out = ["*NODE, NSET=NALL"]
    out += [f"{n}, " + ", ".join(map(number, x)) for n, x in enumerate(nodes, start=1)]
    out.append(f"*ELEMENT, TYPE={element}, ELSET=BEAM")
    out += [f"{e}, " + ", ".join(map(str, c + 1)) for e, c in enumerate(scene.mesh.elements, start=1)]
    for name, chosen in (("CLAMP", scene.held), ("END", scene.watched)):
        out.append(f"*NSET, NSET={name}")
        labels = [str(n + 1) for n in chosen]
        out += [", ".join(labels[k : k + 12]) + "," for k in range(0, len(labels), 12)]
    return out


def load_lines(scene: BeamScene) -> list[str]:
    """The clamps, gravity and the tip force, inside a step."""
    out = ["*BOUNDARY", "CLAMP, 1, 3"]
    g = np.asarray(scene.beam.gravity, dtype=float)
    size = float(np.linalg.norm(g))
    if size > 0.0:
        out += ["*DLOAD", f"BEAM, GRAV, {number(size)}, " + ", ".join(map(number, g / size))]
    if scene.loaded:
        out.append("*CLOAD")
        for n, k in np.argwhere(scene.forces != 0.0):
            out.append(f"{n + 1}, {k + 1}, {number(scene.forces[n, k])}")
    return out
