from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calibration.parameters import parametrisation
from tisim import laws

NAMES = [*laws.names(), "ogden-2", "ogden-3"]


def of(label: str):  # type: ignore[no-untyped-def]
    law, _, terms = label.rpartition("-")
    return parametrisation("ogden", terms=int(terms)) if law == "ogden" else parametrisation(label)


@pytest.mark.parametrize("label", NAMES)
def test_the_start_has_the_modulus_asked_for(label: str) -> None:
    p = of(label)
    u = p.start(shear=1.7e4)
    assert p.label == label
    assert p.moduli(u).shear_modulus == pytest.approx(1.7e4, rel=1e-9)
    assert p.moduli(u).bulk_modulus == pytest.approx(300 * 1.7e4, rel=1e-9)
    assert (p.bounds[:, 0] < u).all()
    assert (u < p.bounds[:, 1]).all()


@pytest.mark.parametrize("label", NAMES)
@given(st.data())
def test_every_point_inside_the_bounds_is_a_sound_material(label: str, data: st.DataObject) -> None:
    p = of(label)
    part = np.array(
        data.draw(st.lists(st.floats(0.001, 0.999), min_size=len(p.names), max_size=len(p.names)))
    )
    u = p.bounds[:, 0] + part * (p.bounds[:, 1] - p.bounds[:, 0])
    values = p.values(u)
    moduli = p.moduli(u)  # also checks the parameters
    shear = sum(v for k, v in values.items() if k.startswith("shear_modulus"))
    assert moduli.shear_modulus == pytest.approx(shear, rel=1e-9)
    assert moduli.bulk_modulus == pytest.approx(shear * values["bulk_ratio"], rel=1e-9)


def test_a_held_coordinate_moves_no_more() -> None:
    p = parametrisation("neo-hookean").holding("bulk_ratio")
    centre, sd = p.prior()
    assert sd[1] == pytest.approx(0.01)
    assert centre[1] == pytest.approx(np.log(300.0))
    assert p.spread[1] == pytest.approx(0.01)


def test_unknown_laws_and_terms_are_refused() -> None:
    with pytest.raises(ValueError, match="expected one of"):
        parametrisation("yeoh")
    with pytest.raises(ValueError, match="expected 1 to 3 terms"):
        parametrisation("ogden", terms=4)
