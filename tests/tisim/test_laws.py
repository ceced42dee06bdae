"""The laws: stress and tangent are derivatives of the energy, and the energy is the paper's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import LAWS, deformations, energy, materials, rotations, slope

from tisim import laws
from tisim.laws import evaluate
from tisim.material import Material

any_material = st.sampled_from(LAWS).flatmap(materials)
many = settings(max_examples=200, deadline=None)


def at(material, F):
    return evaluate(material.law, material.parameters, np.atleast_3d(F).reshape(-1, 3, 3))


def moduli(material):
    return laws.get(material.law).moduli(material.parameters)


def test_registry_holds_the_six_laws_of_the_paper_in_its_order_and_further_ones():
    assert laws.names() == LAWS[:6]
    assert laws.all_names() == LAWS
    assert all(laws.get(name).name == name for name in LAWS)


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_stress_is_the_energys_slope_and_tangent_the_stresss(law, data):
    material, F = data.draw(materials(law)), data.draw(deformations())
    _, P, A = at(material, F)
    by_energy = slope(lambda G: at(material, G)[0], F)
    by_stress = slope(lambda G: at(material, G)[1], F)
    # near rest the stress is small, and rounding of energies of the order of the bulk modulus limits the
    # difference quotient
    rounding = 1e-10 * moduli(material).bulk_modulus
    assert np.abs(by_energy - P[0]).max() < 1e-6 * np.abs(P).max() + rounding
    assert np.abs(np.einsum("jLiK->iKjL", by_stress) - A[0]).max() < 1e-6 * np.abs(A).max()


@many
@given(material=any_material, F=deformations())
def test_energy_is_the_one_the_paper_states(material, F):
    psi, wanted = at(material, F)[0][0], energy(material, F)
    assert abs(psi - wanted) <= 1e-11 * abs(wanted) + 1e-13 * moduli(material).bulk_modulus


@many
@given(material=any_material, F=deformations(), Q=rotations)
def test_objective_and_isotropic(material, F, Q):
    psi, P, A = (v[0] for v in at(material, F))
    turned, stress, tangent = (v[0] for v in at(material, Q @ F))
    tiny = 1e-11 * moduli(material).bulk_modulus
    assert turned == pytest.approx(psi, rel=1e-10, abs=1e-2 * tiny)
    assert np.abs(stress - Q @ P).max() < 1e-10 * np.abs(P).max() + tiny
    rotated = np.einsum("ij,kl,jJlL->iJkL", Q, Q, A)
    assert np.abs(tangent - rotated).max() < 1e-9 * np.abs(A).max()
    other, stress, _ = (v[0] for v in at(material, F @ Q))
    assert other == pytest.approx(psi, rel=1e-10, abs=1e-2 * tiny)
    assert np.abs(stress - P @ Q).max() < 1e-10 * np.abs(P).max() + tiny


@many
@given(material=any_material, Q=rotations)
def test_rest_has_no_stress_and_the_tangent_of_the_stated_moduli(material, Q):
    G, K = moduli(material).shear_modulus, moduli(material).bulk_modulus
    psi, P, A = (v[0] for v in at(material, np.eye(3)))
    assert abs(psi) < 1e-12 * G
    assert np.abs(P).max() < 1e-12 * G
    one = np.eye(3)
    wanted = (K - 2 * G / 3) * np.einsum("iK,jL->iKjL", one, one) + G * (
        np.einsum("ij,KL->iKjL", one, one) + np.einsum("iL,Kj->iKjL", one, one)
    )
    assert np.abs(A - wanted).max() < 1e-12 * K
    assert np.abs(at(material, Q)[1]).max() < 1e-12 * K


@many
@given(F=deformations(), c10=st.floats(1e3, 1e4), c01=st.floats(1e3, 1e4))
def test_ogden_with_exponents_2_and_minus_2_is_mooney_rivlin(F, c10, c01):
    """The form in stretches is as exact as that in invariants, also for repeated stretches."""
    K = 20 * (c10 + c01)
    ours = at(Material(law="ogden", parameters={"mu": (2 * c10, -2 * c01), "alpha": (2, -2), "bulk": K}), F)
    same = at(Material(law="mooney-rivlin", parameters={"c10": c10, "c01": c01, "bulk": K}), F)
    assert np.abs(ours[0] - same[0]).max() < 1e-12 * np.abs(same[0]).max() + 1e-15 * K
    assert np.abs(ours[1] - same[1]).max() < 1e-12 * np.abs(same[1]).max() + 1e-14 * K
    # divided difference of stresses, or its limit: see tisim.kernels.response
    assert np.abs(ours[2] - same[2]).max() < 1e-9 * np.abs(same[2]).max()


@pytest.mark.parametrize("law", LAWS)
@given(G=st.floats(1e2, 1e6), ratio=st.floats(1.0, 5000.0))
def test_parameters_from_moduli_have_these_moduli(law, G, ratio):
    parameters = laws.get(law).from_moduli(G, ratio * G)
    laws.get(law).check(parameters)
    found = laws.get(law).moduli(parameters)
    assert (found.shear_modulus, found.bulk_modulus) == pytest.approx((G, ratio * G), rel=1e-12)


def test_evaluate_refuses_deformations_that_turn_space_over():
    F = np.stack([np.eye(3), np.diag([1.0, 1.0, -1.0]), np.zeros((3, 3))])
    with pytest.raises(ValueError, match=r"det F > 0, which fails for 2 of 3, first at index 1"):
        evaluate("neo-hookean", {"mu": 1.0, "lam": 1.0}, F)
    with pytest.raises(ValueError, match=r"expected shape \(n, 3, 3\)"):
        evaluate("neo-hookean", {"mu": 1.0, "lam": 1.0}, np.eye(3))
    with pytest.raises(ValueError, match="expected one of st-venant"):
        evaluate("hooke", {}, F)
