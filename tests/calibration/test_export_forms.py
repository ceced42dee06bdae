"""Strain energies of other programs: conversions, fits, and CalculiX's solution for a cube in tension."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tisim
from calibration.errors import InputError
from calibration.export import Form, Job
from calibration.export._convert import Conversion, convert, with_poisson
from calibration.export._form_law import REDUCED_POLYNOMIAL, law_of
from calibration.export._forms import COUPLED, exact, isochoric_twin
from calibration.export._response import (
    compare,
    elastic,
    fibre_loss,
    long_time,
    nominal,
    percent,
    softening_loss,
    stress_of,
    worst,
)
from calibration.export._scene import _tip_forces
from calibration.export.targets import calculix, febio
from tisim import Material, laws
from tisim.mesh import beam_mesh
from tisim.parts import MaterialPoints, Spectrum

OGDEN = {"mu": (8e3, -3e3), "alpha": (3.0, -2.0), "bulk": 6e5}
PARAMETERS = {"ogden": OGDEN, "mooney-rivlin": {"c10": 8e3, "c01": 2e3, "bulk": 6e5}}


def material(law: str, bulk: float = 6e5) -> Material:
    parameters = PARAMETERS.get(law) or laws.get(law).from_moduli(2e4, bulk)
    return Material(
        law=law, parameters={**parameters, **({"stiffening": 0.1} if "stiffening" in parameters else {})}
    )


@pytest.mark.parametrize(
    "law", ["ogden", "arruda-boyce", "yeoh", "st-venant-kirchhoff", "stable-neo-hookean"]
)
def test_a_form_is_the_law_that_it_stands_for(law: str) -> None:
    """Compares NumPy code in principal stretches with the kernels of the solvers."""
    m = material(law)
    form = exact(law, m.parameters)
    assert form is not None
    stretches = np.random.default_rng(0).uniform(0.7, 1.5, (6, 3))
    np.testing.assert_allclose(form.stress(stretches), stress_of(m)(stretches), rtol=1e-9, atol=1e-6)
    assert form.shear_modulus == pytest.approx(laws.get(law).moduli(m.parameters).shear_modulus)
    with law_of(form) as back:
        assert back is not None
        stress = stress_of(Material(law=back[0], parameters=back[1]))(stretches)
    np.testing.assert_allclose(stress, form.stress(stretches), rtol=1e-9, atol=1e-6)


def test_a_polynomial_is_a_law_as_long_as_it_is_used() -> None:
    """Three terms and their derivatives; any volumetric energy is taken for the logarithmic one if asked."""
    form = Form(kind="polynomial", bulk=6e5, terms=(((1, 0), 8e3), ((3, 0), 2e3)), volume="linear")
    stretches = np.random.default_rng(0).uniform(0.7, 1.5, (6, 3))
    with law_of(form) as none:
        assert none is None
    with law_of(form, any_volume=True) as found:
        assert found is not None
        assert laws.check_law(REDUCED_POLYNOMIAL.name).ok
        stress = stress_of(Material(law=found[0], parameters=found[1]))(stretches)
    np.testing.assert_allclose(stress, replace(form, volume="log").stress(stretches), rtol=1e-9, atol=1e-6)
    assert REDUCED_POLYNOMIAL.name not in laws.all_names()


def test_twins_differ_from_their_law_in_volume_alone() -> None:
    stretches = np.array([[1.3, 0.9, 1.0 / 1.17], [0.7, 1.3, 1.0 / 0.91]])
    for law in ("neo-hookean", "stiffening-neo-hookean"):
        m = material(law)
        twin = isochoric_twin(law, m.parameters)
        assert twin is not None
        off = twin.stress(stretches) - stress_of(m)(stretches)
        np.testing.assert_allclose(off * stretches, (off * stretches)[:, :1].repeat(3, axis=1), rtol=1e-8)


def test_the_sides_of_a_test_are_free_of_stress() -> None:
    form = Form(kind="polynomial", bulk=2e9, terms=(((1, 0), 1e4),))  # nearly incompressible: closed form
    at = np.array([0.7, 1.0, 1.6])
    for mode, wanted in (
        ("uniaxial", 2e4 * (at - at**-2)),
        ("equibiaxial", 2e4 * (at - at**-5)),
        ("planar", 2e4 * (at - at**-3)),
    ):
        np.testing.assert_allclose(nominal(form.stress, mode, at), wanted, rtol=1e-4, atol=1.0)


def converted(law: str, *kinds: str, most_loss: float = 0.5, most_poisson: float | None = None) -> Conversion:
    return convert(
        material(law), lambda form: form if form.kind in kinds else None,
        low=0.85, high=1.2, most_loss=most_loss, program="made-up", most_poisson=most_poisson,
    )  # fmt: skip


def test_a_law_that_is_there_stays() -> None:
    found = converted("neo-hookean", "neo-hookean", "polynomial")
    assert (found.how, found.form.kind) == ("same", "neo-hookean")
    assert worst(found.differences).rms < 1e-9


def test_eight_chains_are_fitted_and_the_loss_is_that_of_the_curves() -> None:
    found = converted("eight-chain", "polynomial")
    assert found.how == "fit"
    off = worst(found.differences)
    assert off.rms < 0.01
    again = compare(stress_of(material("eight-chain")), found.form.stress, 0.85, 1.2)
    assert worst(again) == off


def test_a_law_too_far_off_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"--to made-up: ogden has no counterpart there: the nearest, st-venant-k"
    ):
        converted("ogden", "st-venant-kirchhoff", most_loss=0.05)
    with pytest.raises(InputError, match="has no law that could stand for ogden"):
        converted("ogden")


def test_a_smaller_poissons_ratio_keeps_youngs_modulus() -> None:
    form = Form(kind="ogden", bulk=6e6, mu=(1e4,), alpha=(3.0,))
    capped = with_poisson(form, 0.45)
    assert (capped.young, capped.poisson) == pytest.approx((form.young, 0.45))
    found = converted("stable-neo-hookean", "stable-neo-hookean", most_poisson=0.45)
    assert found.form.poisson == pytest.approx(0.45)
    assert found.poisson is not None
    assert found.poisson > 0.48


def test_losses_of_parts_have_the_size_of_the_parts() -> None:
    plain = material("neo-hookean", bulk=6e6)
    stiffer = replace(plain, fibres=tisim.HolzapfelGasserOgden(direction=(0, 0, 1), k1=5e3))
    # at small strain fibres add 4 k1 to Young's modulus, 3 G
    assert fibre_loss(stiffer, 1.001) == pytest.approx(4 * 5e3 / 6e4, rel=0.05)
    softer = replace(plain, softening=tisim.OgdenRoxburgh(r=2.0, m=1.0))
    assert softening_loss(softer, 1.3) == pytest.approx(0.5, abs=0.01)  # 1/r for small m
    slow = replace(plain, viscosity=tisim.Prony(fractions=(0.4,), times=(1.0,), modulus="instantaneous"))
    moduli = laws.get("neo-hookean").moduli(elastic(slow).parameters)
    assert moduli.shear_modulus == pytest.approx(0.6 * 2e4)
    assert moduli.bulk_modulus == pytest.approx(6e6)
    assert percent(0.0314) == "3.1 %"


def test_long_time_moduli_state_the_same_material() -> None:
    """Law, fibres and softening energy together: the same stress at once, relaxed, and in unloading."""
    card = replace(
        material("mooney-rivlin"),
        viscosity=tisim.Prony(fractions=(0.3, 0.2), times=(1.0, 30.0), modulus="instantaneous"),
        fibres=tisim.HolzapfelGasserOgden(direction=(1.0, 0.0, 0.0), k1=5e3, k2=0.5),
        softening=tisim.OgdenRoxburgh(r=2.0, m=800.0, beta=0.1),
    )
    stated = long_time(card)
    assert stated.viscosity.modulus == "long-time"  # type: ignore[union-attr]
    assert long_time(stated) is stated
    stresses = []
    for m in (card, stated):
        points, found = MaterialPoints(m, 1), []
        for stretch, seconds in ((1.3, 1e-6), (1.3, 1.0), (1.3, 1e4), (1.1, 1e-6), (1.1, 1e4)):
            F = np.diag([stretch, stretch**-0.5, stretch**-0.5])[None]
            points.begin(seconds)
            found.append(points.evaluate(F)[1][0])
            points.accept(F)
        stresses.append(found)
    np.testing.assert_allclose(stresses[1], stresses[0], rtol=1e-9, atol=1e-6)
    relaxed = elastic(card)
    assert relaxed == elastic(stated)
    assert relaxed.fibres.k1 == 2.5e3  # type: ignore[union-attr]


def test_fewer_terms_relax_alike() -> None:
    times = np.geomspace(0.1, 100.0, 7)
    spectrum = Spectrum(equilibrium=1.0, strengths=np.full(7, 0.025), times=times)
    found, off = febio.fewer(spectrum, 6)
    assert len(found.times) == 6
    assert 0.0 < off < 0.005
    for t in (0.0, 0.3, 20.0):
        assert found.modulus(t) == pytest.approx(spectrum.modulus(t), rel=0.005)
    assert febio.fewer(spectrum, 7) == (spectrum, 0.0)


def test_a_tip_force_is_spread_over_the_end_face() -> None:
    for kind in ("tet4", "tet10"):
        mesh = beam_mesh(length=0.03, section=tisim.Circle(radius=0.01), kind=kind, radial_elements=2)  # type: ignore[arg-type]
        beam = tisim.Beam(material=material("neo-hookean"), length=0.03, tip_force=(0.1, 0.0, -0.3))
        forces = _tip_forces(mesh, beam)
        np.testing.assert_allclose(forces.sum(axis=0), beam.tip_force, atol=1e-15)
        np.testing.assert_allclose(mesh.nodes[:, 1:].T @ forces, 0.0, atol=1e-12)  # no moment about the axis
        assert not forces[mesh.nodes[:, 0] < 0.03].any()


# -- CalculiX --

CCX = shutil.which("ccx")
CUBE = """*NODE, NSET=NALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=ONE
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=FAR
2, 3, 6, 7
"""


def pulled_by_calculix(lines: list[str], stretch: float, folder: Path) -> float:
    """Force [N] on a cube of 1 m in uniaxial tension along x."""
    name = next(x.partition("NAME=")[2] for x in lines if x.startswith("*MATERIAL"))
    deck = [CUBE.rstrip(), *lines, f"*SOLID SECTION, ELSET=ONE, MATERIAL={name}", "*STEP, NLGEOM", "*STATIC"]
    deck += ["0.2, 1.", "*BOUNDARY"]
    deck += [f"{n}, 1, 1" for n in (1, 4, 5, 8)] + [f"{n}, 2, 2" for n in (1, 2, 5, 6)]
    deck += [f"{n}, 3, 3" for n in (1, 2, 3, 4)] + [f"FAR, 1, 1, {stretch - 1.0}"]
    deck += ["*NODE PRINT, NSET=FAR, TOTALS=ONLY, FREQUENCY=1000", "RF", "*END STEP", ""]
    (folder / "cube.inp").write_text("\n".join(deck))
    assert CCX is not None
    subprocess.run([CCX, "-i", "cube"], cwd=folder, capture_output=True, check=True, timeout=60)
    values = [x.split() for x in (folder / "cube.dat").read_text().splitlines() if x.strip()]
    return float(values[-1][0])


def job(m: Material) -> Job:
    from calibration.export import _inp

    plain = replace(m, fibres=None)
    found = convert(plain, lambda f: _inp.writes(f, m), low=0.9, high=1.1, most_loss=0.5, program="calculix")
    return Job(name="S", material=m, conversion=found, keeps=frozenset(calculix.keeps(m, found.form)))


@pytest.mark.skipif(CCX is None, reason="needs ccx (apt-get install calculix-ccx)")
@pytest.mark.parametrize("law", ["ogden", "mooney-rivlin", "arruda-boyce", "yeoh", "neo-hookean"])
def test_calculix_pulls_a_cube_as_the_form_says(law: str, tmp_path: Path) -> None:
    """The written material has the intended stress, for each law in tension and compression."""
    made = job(material(law))
    for stretch in (1.4, 0.75):
        force = pulled_by_calculix(calculix.material_lines(made), stretch, tmp_path)
        wanted = nominal(made.form.stress, "uniaxial", np.array([stretch]))[0]
        assert force == pytest.approx(wanted, rel=1e-4), stretch


@pytest.mark.skipif(CCX is None, reason="needs ccx (apt-get install calculix-ccx)")
def test_calculix_has_the_cards_fibres(tmp_path: Path) -> None:
    fibres = tisim.HolzapfelGasserOgden(direction=(-2.0, 0.0, 0.0), k1=6e3, k2=0.8)
    m = replace(material("neo-hookean"), fibres=fibres)
    made = job(m)
    assert made.keeps == {"fibres"}
    force = pulled_by_calculix(calculix.material_lines(made), 1.3, tmp_path)
    wanted = nominal(stress_of(m), "uniaxial", np.array([1.3]))[0]
    assert force == pytest.approx(wanted, rel=0.02)  # the volumetric energy differs: K/2 (J - 1)^2 there
    assert force > 1.15 * nominal(stress_of(replace(m, fibres=None)), "uniaxial", np.array([1.3]))[0]


@pytest.mark.parametrize("direction", [(1.0, 1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 3.0, 0.0), (2.0, 3.0, 0.0)])
def test_calculix_takes_any_fibre_in_the_plane(direction: tuple[float, float, float]) -> None:
    """Its user material stops at a sum of squares above 1 of the two components that it reads."""
    fibres = tisim.HolzapfelGasserOgden(direction=direction, k1=6e3, k2=0.8)
    lines = calculix.material_lines(job(replace(material("neo-hookean"), fibres=fibres)))
    row = [float(x) for x in lines[lines.index("*USER MATERIAL, CONSTANTS=6") + 1].split(",") if x.strip()]
    assert row[2] ** 2 + row[3] ** 2 <= 1.0
    assert row[3] / row[2] == pytest.approx(direction[1] / direction[0])


def test_coupled_forms_are_tisims_laws() -> None:
    assert set(COUPLED) <= set(laws.all_names())
