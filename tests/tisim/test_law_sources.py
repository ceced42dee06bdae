"""tisim's laws against the formulas printed in the paper and against SOFA's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import AB, deformations, energy, materials, slope

from tisim import laws
from tisim.laws import evaluate
from tisim.material import Material


def pressure(material, F):
    """Factor [Pa] of the laws' docstrings: at J = 1 the printed stress is tisim's plus this times F^-T."""
    p = material.parameters
    l = np.linalg.svd(F, compute_uv=False)
    if material.law == "ogden":
        return sum(m * (l**a).sum() / 3 for m, a in zip(p["mu"], p["alpha"], strict=True))
    I1 = (l**2).sum()
    slope_I1 = p["mu"] * sum(c * (i + 1) * I1**i / p["locking"] ** (2 * i) for i, c in enumerate(AB))
    return 2 / 3 * slope_I1 * I1


@pytest.mark.parametrize("law", ["ogden", "arruda-boyce"])
@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_printed_formula_is_not_stress_free_and_differs_by_a_pressure(law, data):
    material = data.draw(materials(law))
    moduli = laws.get(law).moduli(material.parameters)
    at_rest = slope(lambda G: energy(material, G, printed=True), np.eye(3))
    p = material.parameters
    stated = sum(p["mu"]) if law == "ogden" else moduli.shear_modulus
    assert at_rest == pytest.approx(
        stated * np.eye(3), abs=1e-6 * max(moduli.shear_modulus, abs(stated)) + 1e-9 * moduli.bulk_modulus
    )
    assert np.abs(evaluate(law, p, np.eye(3)[None])[1]).max() < 1e-12 * moduli.shear_modulus

    F = data.draw(deformations())
    F /= np.cbrt(np.linalg.det(F))
    psi, P, _ = (v[0] for v in evaluate(law, p, F[None]))
    printed = slope(lambda G: energy(material, G, printed=True), F)
    difference = pressure(material, F) * np.linalg.inv(F).T
    scale = max(np.abs(printed).max(), np.abs(P).max(), np.abs(difference).max())
    assert energy(material, F, printed=True) == pytest.approx(psi, rel=1e-9, abs=1e-12 * moduli.bulk_modulus)
    assert np.abs(printed - P - difference).max() < 1e-6 * scale + 1e-9 * moduli.bulk_modulus


def sofa(law, values, F):
    """Energy whose derivative is SOFA's stress for a ParameterSet (physics.md, section 1; SOFA 26.12-dev)."""
    C = np.swapaxes(F, -1, -2) @ F
    J, I1 = np.linalg.det(F), np.trace(C, axis1=-2, axis2=-1)
    I2 = (I1**2 - np.trace(C @ C, axis1=-2, axis2=-1)) / 2
    i1, i2, ln = I1 / np.cbrt(J) ** 2, I2 / np.cbrt(J) ** 4, np.log(J)
    if law == "ogden":
        mu1, alpha, K = values
        power = (np.linalg.eigvalsh(C) ** (alpha / 2)).sum(-1)
        return mu1 / alpha**2 * (J ** (-alpha / 3) * power - 3) + K / 2 * ln**2
    if law == "arruda-boyce":
        mu, K = values
        return mu * sum(c / 8**i * (i1 ** (i + 1) - 3 ** (i + 1)) for i, c in enumerate(AB)) + K / 2 * ln**2
    if law == "mooney-rivlin":
        c10, c01, K = values
        return c10 * (i1 - 3) + c01 * (i2 - 3) + K / 2 * ln**2
    mu, lam = values
    if law == "neo-hookean":
        return mu / 2 * (I1 - 3) - mu * ln + lam / 2 * ln**2
    if law == "stable-neo-hookean":
        return (mu * (I1 - 3) + (lam + mu) * (J - 1 - mu / (lam + mu)) ** 2) / 2
    E = (C - np.eye(3)) / 2
    trace = np.trace(E, axis1=-2, axis2=-1)
    return lam / 2 * trace**2 + mu * np.trace(E @ E, axis1=-2, axis2=-1)


# law, SOFA's ParameterSet, the same in tisim's parameters, (G, K) by physics.md
SOFA = [
    ("st-venant-kirchhoff", (7e3, 9e4), {"mu": 7e3, "lam": 9e4}, (7e3, 9e4 + 14e3 / 3)),
    ("neo-hookean", (7e3, 9e4), {"mu": 7e3, "lam": 9e4}, (7e3, 9e4 + 14e3 / 3)),
    ("stable-neo-hookean", (7e3, 9e4), {"mu": 7e3, "lam": 9e4}, (7e3, 9e4 + 14e3 / 3)),
    ("mooney-rivlin", (3e3, 1e3, 9e4), {"c10": 3e3, "c01": 1e3, "bulk": 9e4}, (8e3, 9e4)),
    ("ogden", (8e3, 5.0, 9e4), {"mu": 8e3 / 5.0, "alpha": 5.0, "bulk": 9e4}, (4e3, 9e4)),
    ("arruda-boyce", (7e3, 9e4), {"mu": 7e3, "locking": 8**0.5, "bulk": 9e4}, (1.0851 * 7e3, 9e4)),
]


@pytest.mark.parametrize(("law", "values", "parameters", "moduli"), SOFA)
def test_sofas_parameter_set_maps_as_the_docstrings_say(law, values, parameters, moduli):
    F = np.eye(3) + 0.4 * np.random.default_rng(5).uniform(-1, 1, (20, 3, 3))
    ours, theirs = evaluate(law, parameters, F)[0], sofa(law, values, F)
    constant = sofa(law, values, np.eye(3))
    assert ours == pytest.approx(theirs - constant, rel=1e-10)
    found = laws.get(law).moduli(Material(law=law, parameters=parameters).parameters)
    assert (found.shear_modulus, found.bulk_modulus) == pytest.approx(moduli, rel=5e-5)


def test_eight_chains_are_their_series_far_from_the_ends_and_lock_at_them():
    chains = {"mu": 7e3, "locking": 6.0, "bulk": 9e4}
    of_series = laws.get("arruda-boyce").moduli({"mu": 1.0, "locking": 6.0, "bulk": 1.0}).shear_modulus
    series = {**chains, "mu": 7e3 / of_series}
    F = np.eye(3) + 0.4 * np.random.default_rng(6).uniform(-1, 1, (20, 3, 3))
    ours, theirs = (evaluate(n, p, F)[1] for n, p in (("eight-chain", chains), ("arruda-boyce", series)))
    assert ours == pytest.approx(theirs, rel=1e-5, abs=1e-3)
    # at 98 % of the locking length the force is 1 / (1 - 0.98) over 3 x, relative to rest; linear beyond it
    x = np.array([0.98, 0.999, 1.0, 1.001])
    pulled = [np.max(np.roots([1.0, 0.0, -3.0 * (6.0 * y) ** 2, 2.0]).real) for y in x]
    F = np.array([np.diag([s, s**-0.5, s**-0.5]) for s in pulled])
    deviator = np.array(
        [
            P[0, 0] - P[1, 1] * s**-1.5
            for P, s in zip(evaluate("eight-chain", chains, F)[1], pulled, strict=True)
        ]
    )
    slopes = deviator / (7e3 * (np.array(pulled) - np.array(pulled) ** -2))
    at_rest = np.polynomial.polynomial.polyval(3.0 / 36.0, [1.0, 0.2, 33 / 525, 152 / 7000, 5190 / 673750])
    assert slopes[0] == pytest.approx(50.0 / (3.0 * 0.98) / at_rest, rel=1e-4)
    steps = np.diff(slopes[1:] * x[1:])
    assert steps == pytest.approx([0.001 * 200.0**2 / 3.0 / at_rest] * 2, rel=1e-4)  # b is 200 at the limit
