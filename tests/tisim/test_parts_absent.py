"""Scenes without viscosity, softening or fibres use kernels without these parts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tisim
from tisim import laws
from tisim.discretisation.body import NO_STATE, Discretisation, DiscretisedBody
from tisim.kernels.elements import element_kernels
from tisim.kernels.response import NONE
from tisim.problems.homogeneous.solve import coupon_mesh

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=3e4, bulk_modulus=6e5)
PARTS = {
    "viscosity": tisim.Prony(fractions=(0.3,), times=(1.0,)),
    "softening": tisim.OgdenRoxburgh(r=1.6, m=1e3),
    "fibres": tisim.HolzapfelGasserOgden(direction=(1.0, 0.0, 0.0), k1=1e4, k2=1.0),
}


@pytest.fixture(scope="module")
def discretisation() -> Discretisation:
    return Discretisation.build(coupon_mesh(), np.zeros(0, dtype=np.int32))


def test_a_law_alone_has_its_own_kernels_numbers_and_no_state(discretisation: Discretisation) -> None:
    body = DiscretisedBody(discretisation, SOFT)
    law = laws.get(SOFT.law)
    assert (body._energy, body._forces, body._stiffness, body._pressures) == element_kernels(
        law, features=NONE
    )
    assert np.array_equal(body._prm, law.pack(SOFT.parameters))
    assert body.state is NO_STATE
    assert body.history is None
    assert not body.remembers
    assert not SOFT.has_parts
    before = body._prm.copy()
    body.begin(1.0)
    body.accept(discretisation.mesh.nodes)
    assert np.array_equal(body._prm, before)


@pytest.mark.parametrize("part", PARTS)
def test_each_part_has_kernels_of_its_own(part: str, discretisation: Discretisation) -> None:
    body = DiscretisedBody(discretisation, replace(SOFT, **{part: PARTS[part]}))  # type: ignore[arg-type]
    law = laws.get(SOFT.law)
    assert body.features.any
    assert body._forces is not element_kernels(law, features=NONE)[1]
    assert len(body._prm) == len(law.pack(SOFT.parameters)) + body.features.tail_size
    assert (body.history is None) == (part == "fibres")
