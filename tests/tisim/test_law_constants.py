"""Constants of a law for other moduli: exact where they stay, and with the moduli that are asked for."""

import numpy as np
import pytest

from tisim import laws
from tisim.laws import Law, Moduli

SPECIMENS = {
    "st-venant-kirchhoff": {"mu": 3e4, "lam": 1.1e6},
    "neo-hookean": {"mu": 3e4, "lam": 1.1e6},
    "stable-neo-hookean": {"mu": 3e4, "lam": 1.1e6},
    "mooney-rivlin": {"c10": 7e3, "c01": 3.3e3, "bulk": 9e5},
    "ogden": {"mu": (2.1e3, -7.7e2), "alpha": (3.1, -2.3), "bulk": 9e5},
    "arruda-boyce": {"mu": 1.3e4, "locking": 1.7, "bulk": 9e5},
    "yeoh": {"mu": 1.3e4, "stiffening": 0.07, "bulk": 9e5},
    "eight-chain": {"mu": 1.3e4, "locking": 1.7, "bulk": 9e5},
    "stiffening-neo-hookean": {"mu": 3e4, "stiffening": 0.07, "lam": 1.1e6},
}
STRAINED = np.diag([1.3, 0.9, 0.88])[None] + 0.05 * np.eye(3)[None, ::-1]


def test_every_law_has_a_specimen_here():
    assert set(SPECIMENS) == set(laws.all_names())


@pytest.mark.parametrize(("law", "parameters"), SPECIMENS.items())
def test_a_scaled_law_has_the_multiple_of_energy_and_stress(law, parameters):
    stiffer = laws.scaled(law, parameters, 2.5)
    assert list(stiffer) == list(parameters)
    for found, known in zip(
        laws.evaluate(law, stiffer, STRAINED), laws.evaluate(law, parameters, STRAINED), strict=True
    ):
        assert found == pytest.approx(2.5 * known, rel=1e-12, abs=1e-9)


@pytest.mark.parametrize(("law", "parameters"), SPECIMENS.items())
def test_other_moduli_are_those_asked_for_and_the_constants_keep_their_ratios(law, parameters):
    before = laws.get(law).moduli(parameters)
    moved = laws.with_moduli(law, parameters, shear_modulus=1.7e4, bulk_modulus=4.3e5)
    after = laws.get(law).moduli(moved)
    assert (after.shear_modulus, after.bulk_modulus) == pytest.approx((1.7e4, 4.3e5), rel=1e-14)
    for name, (unit, _) in laws.get(law).parameters.items():
        if unit != "Pa":
            assert moved[name] == parameters[name]
        elif name not in ("lam", "bulk"):
            ratio = 1.7e4 / before.shear_modulus
            assert np.array(moved[name]) == pytest.approx(ratio * np.array(parameters[name]), rel=1e-14)
    # a constant that is the shear modulus is exactly the one that was asked for
    if parameters.get("mu") == before.shear_modulus:
        assert moved["mu"] == 1.7e4


@pytest.mark.parametrize(("law", "parameters"), SPECIMENS.items())
def test_a_change_of_the_bulk_modulus_leaves_the_other_constants_to_the_last_bit(law, parameters):
    shear = laws.get(law).moduli(parameters).shear_modulus
    moved = laws.with_moduli(law, parameters, shear_modulus=shear, bulk_modulus=4.3e5)
    kept = {n for n in parameters if n not in ("lam", "bulk")}
    assert {n: moved[n] for n in kept} == {n: parameters[n] for n in kept}
    assert laws.get(law).moduli(moved).bulk_modulus == pytest.approx(4.3e5, rel=1e-15)


def test_a_law_of_other_constants_gets_its_volumetric_ones_from_its_moduli():
    law = Law(
        name="young-poisson",
        title="By Young's modulus",
        parameters={"young": ("Pa", "scalar"), "nu": ("-", "scalar"), "limit": ("-", "scalar")},
        family="invariant",
        theta="log",
        energy=laws.get("neo-hookean").energy,
        pack=lambda p: (p["young"],),
        kappa=lambda p: p["young"],
        moduli=lambda p: Moduli(
            shear_modulus=p["young"] / (2.0 * (1.0 + p["nu"])),
            bulk_modulus=p["young"] / (3.0 * (1.0 - 2.0 * p["nu"])),
        ),
        from_moduli=lambda g, k: {
            "young": Moduli(shear_modulus=g, bulk_modulus=k).young_modulus,
            "nu": Moduli(shear_modulus=g, bulk_modulus=k).poisson_ratio,
            "limit": 30.0,
        },
    )
    laws.register(law)
    try:
        moved = laws.with_moduli(
            law.name, {"young": 1e4, "nu": 0.4, "limit": 12.0}, shear_modulus=2e4, bulk_modulus=3e5
        )
        found = law.moduli(moved)
    finally:
        laws.unregister(law.name)
    assert (found.shear_modulus, found.bulk_modulus) == pytest.approx((2e4, 3e5), rel=1e-12)
    assert moved["limit"] == 12.0


@pytest.mark.parametrize(
    ("law", "amount", "own"),
    [
        ("yeoh", 0.3, {"stiffening": 0.3}),
        ("mooney-rivlin", 0.25, {"c10": 0.375 * 2e4, "c01": 0.125 * 2e4}),
        ("eight-chain", 0.25, {"locking": 2.0}),
    ],
)
def test_an_extension_has_its_constant_and_the_moduli(law, amount, own):
    found = laws.extension(law, amount, shear_modulus=2e4, bulk_modulus=6e6)
    laws.get(law).check(found)
    assert own.items() <= found.items()
    assert laws.get(law).moduli(found) == Moduli(shear_modulus=2e4, bulk_modulus=6e6)


@pytest.mark.parametrize("amount", [-0.1, 0.0, 1.0])
def test_chains_that_lock_at_rest_are_refused(amount):
    with pytest.raises(ValueError, match=f"expected a value between 0 and 1, got {amount:g}"):
        laws.extension("eight-chain", amount, shear_modulus=2e4, bulk_modulus=6e6)


@pytest.mark.parametrize("nu", [-0.9, 0.0, 0.3, 0.499])
def test_poissons_ratio_and_youngs_modulus_are_those_of_isotropic_elasticity(nu):
    found = Moduli(shear_modulus=2e4, bulk_modulus=1.0).with_poisson_ratio(nu)
    assert found.shear_modulus == 2e4
    assert found.poisson_ratio == pytest.approx(nu, abs=1e-13)
    assert found.young_modulus == pytest.approx(2.0 * 2e4 * (1.0 + nu), rel=1e-13)
    assert found.young_modulus == pytest.approx(3.0 * found.bulk_modulus * (1.0 - 2.0 * nu), rel=1e-10)


@pytest.mark.parametrize("nu", [-1.0, 0.5, 0.6, float("nan")])
def test_poissons_ratios_that_no_material_has_are_refused(nu):
    with pytest.raises(ValueError, match=r"expected a Poisson ratio between -1 and 0\.5, got "):
        Moduli(shear_modulus=2e4, bulk_modulus=1.0).with_poisson_ratio(nu)
