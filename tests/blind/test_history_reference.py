"""The stored block of tetrahedra (FElupe) is in equilibrium by laws implemented here from their formulas."""

from __future__ import annotations

import json

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import erf

from benchmarks import references

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def stored() -> dict:
    from pathlib import Path

    return json.loads((Path(references.__file__).parent / "history.json").read_text(encoding="utf-8"))


def gradients(stored: dict, displacement: Array) -> tuple[Array, Array, Array]:
    """Volumes (t,), gradients of the shape functions (t, 4, 3) and F (t, 3, 3)."""
    nodes, tets = np.array(stored["nodes"]), np.array(stored["tetrahedra"])
    edges = np.swapaxes(nodes[tets[:, 1:]] - nodes[tets[:, :1]], 1, 2)
    inner = np.linalg.inv(edges)
    slopes = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    F = np.einsum("tai,taj->tij", (nodes + displacement)[tets], slopes)
    return np.linalg.det(edges) / 6.0, slopes, F


def test_the_softening_block_is_in_equilibrium_frame_after_frame(stored: dict) -> None:
    about, soft = stored["about"], stored["softening"]
    mu, bulk, tets = about["mu"], about["bulk"], np.array(stored["tetrahedra"])
    largest = np.zeros(len(tets))
    held = stored["clamped"] + stored["driven"]
    softest = 1.0
    for displacement, force in zip(soft["displacement"], soft["force"], strict=True):
        volume, slopes, F = gradients(stored, np.array(displacement))
        J = np.linalg.det(F)
        H = np.swapaxes(np.linalg.inv(F), 1, 2)
        I1 = np.einsum("tij,tij->t", F, F)
        energy = mu / 2 * (J ** (-2 / 3) * I1 - 3)
        largest = np.maximum(largest, energy)
        eta = 1 - erf((largest - energy) / (soft["m"] + soft["beta"] * largest)) / soft["r"]
        softest = min(softest, float(eta.min()))
        P = (eta * mu * J ** (-2 / 3))[:, None, None] * (F - I1[:, None, None] / 3 * H)
        P += (bulk * np.log(J))[:, None, None] * H
        nodal = np.zeros((len(stored["nodes"]), 3))
        np.add.at(nodal, tets, np.einsum("t,tij,taj->tai", volume, P, slopes))
        assert nodal[stored["driven"]].sum(axis=0) == pytest.approx(force, abs=1e-8)
        assert np.abs(np.delete(nodal, held, axis=0)).max() < 1e-8  # relative to 1 N
    assert softest < 0.7


def test_the_viscous_blocks_steps_are_fine_and_its_force_relaxes(stored: dict) -> None:
    viscous = stored["viscosity"]
    force = np.array(viscous["force"])[:, 0]
    assert viscous["force_change_by_halving_steps"] < 1e-5
    assert force[1] < 0.9 * force[0]
    assert force[3] > force[2] > 0.0
