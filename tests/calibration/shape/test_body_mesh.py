"""Surfaces of simulated bodies against the volume of their elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tisim
from calibration.errors import InputError
from calibration.shape import body_mesh
from tisim.mesh import volumes

MATERIAL = tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3)


@pytest.fixture(scope="module")
def half() -> tisim.Result:
    (result,) = tisim.simulate(
        [tisim.Beam(material=MATERIAL, length=0.05, axial_element_size=0.01, radial_elements=1)]
    )
    assert result.ok
    assert result.mesh.symmetry == ("y",)
    return result


def element_volume(result: tisim.Result) -> float:
    moved = replace(result.mesh, nodes=result.positions[-1])
    return float(volumes(moved).sum()) * 2 ** len(result.mesh.symmetry)


def test_half_model_becomes_the_whole_closed_body(half: tisim.Result) -> None:
    body = body_mesh(half)
    assert body.is_watertight
    assert body.is_winding_consistent
    assert body.body_count == 1
    assert body.bounds[0, 1] == pytest.approx(-body.bounds[1, 1], abs=1e-12)
    assert body.volume == pytest.approx(element_volume(half), rel=4e-3)


def test_finer_cuts_close_in_on_the_curved_elements_volume(half: tisim.Result) -> None:
    true = element_volume(half)
    miss = [abs(body_mesh(half, subdivide=n).volume / true - 1) for n in (2, 4, 8)]
    assert miss[0] / miss[1] == pytest.approx(4.0, rel=0.1)
    assert miss[1] / miss[2] == pytest.approx(4.0, rel=0.1)


def test_default_beam_keeps_its_volume_within_the_promise() -> None:
    (result,) = tisim.simulate([tisim.Beam(material=MATERIAL, length=0.03)])
    loss = 1 - body_mesh(result).volume / element_volume(result)
    assert 0 < loss < 1e-3


def test_nodes_on_the_surface_are_its_vertices(half: tisim.Result) -> None:
    body = body_mesh(half)
    nodes = half.positions[-1][np.unique(half.mesh.facet_sets["surface"])]
    gap = np.linalg.norm(body.vertices[:, None] - nodes[None], axis=2).min(axis=0)
    assert gap.max() < 1e-15


@pytest.mark.parametrize("element", ["tet4", "hex8"])
def test_other_elements(element) -> None:
    beam = tisim.Beam(material=MATERIAL, length=0.03, axial_element_size=0.01, element=element)
    (result,) = tisim.simulate([beam])
    body = body_mesh(result)
    assert body.is_watertight
    assert body.volume == pytest.approx(element_volume(result), rel=1e-4)


def test_no_frame_is_one_sentence(half: tisim.Result) -> None:
    empty = replace(half, positions=half.positions[:0], message="it broke")
    with pytest.raises(InputError, match="no frame: it broke"):
        body_mesh(empty)
    with pytest.raises(InputError, match="frame 7"):
        body_mesh(half, frame=7)
