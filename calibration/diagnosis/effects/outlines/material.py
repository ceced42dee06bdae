"""Effects of the material in photographs of beams: changes of the scene's law, moduli or density."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._material_parts import stiffening, viscosity_of
from calibration.measurements._effect import HandedOn, Occurrence
from calibration.measurements.outlines._effect import OutlineEffect, Situation
from tisim import Beam, laws

Array = NDArray[np.float64]


def _moduli(beam: Beam) -> laws.Moduli:
    return laws.get(beam.material.law).moduli(beam.material.parameters)


def _at(beam: Beam, moduli: laws.Moduli) -> Beam:
    """The beam with other moduli of its material; dimensionless constants (a stiffening) stay."""
    material = beam.material
    parameters = laws.with_moduli(material.law, material.parameters, **vars(moduli))
    return replace(beam, material=replace(material, parameters=parameters))


# -- density --
# The density differs from the stated one by this fraction: only the ratio of stiffness to weight matters.


def _bend_density(beam: Beam, amplitude: float, _: Situation) -> Beam:
    heavier = beam.material.density * (1.0 + amplitude)
    return replace(beam, material=replace(beam.material, density=heavier))


DENSITY = OutlineEffect(
    effect=catalogue.DENSITY,
    # minus the baseline's step in ln G: the two are aliases, so their finite differences must agree
    step=-0.003,
    bounds=(-0.3, 0.3),
    prior_scale=0.05,
    bend=_bend_density,
)


# -- strain-stiffening --
# Strain stiffening: W has an additional term mu/2 a (I1bar - 3)^2.


def _bend_strain_stiffening(beam: Beam, amplitude: float, _: Situation) -> Beam:
    known = beam.material.parameters["stiffening"]  # 0 in the baseline's law
    assert isinstance(known, float)
    parameters = {**beam.material.parameters, "stiffening": known + amplitude}
    return replace(beam, material=replace(beam.material, parameters=parameters))


STRAIN_STIFFENING = OutlineEffect(
    effect=catalogue.STRAIN_STIFFENING,
    step=0.1,
    bounds=(0.0, 4.0),
    prior_scale=1.5,
    bend=_bend_strain_stiffening,
    hands_on=stiffening,
)


# -- compressibility --
# Compressibility: Poisson's ratio is lower than the baseline's by this amount.


def _bend_compressibility(beam: Beam, amplitude: float, _: Situation) -> Beam:
    moduli = _moduli(beam)
    return _at(beam, moduli.with_poisson_ratio(moduli.poisson_ratio - amplitude))


COMPRESSIBILITY = OutlineEffect(
    effect=catalogue.COMPRESSIBILITY,
    step=0.03,
    bounds=(0.0, 0.3),
    prior_scale=0.05,
    bend=_bend_compressibility,
)


# -- creep --
# Creep: the modulus falls by this fraction of its value at 1 s per decade of time since release.


def _bend_creep(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    moduli = _moduli(beam)
    part = 1.0 - amplitude * float(np.log10(situation.time))
    softer = laws.Moduli(shear_modulus=part * moduli.shear_modulus, bulk_modulus=part * moduli.bulk_modulus)
    return _at(beam, softer)


def _viscosity_creep(found: Occurrence) -> HandedOn:
    """Prony series with the modulus at each time as the relaxation function.

    Under a constant load the two differ by the fraction (pi c / 2.3)^2 / 6 for a creep of the fraction c per
    decade (0.3 % for c = 10 %).
    """
    times = [r.time for r in found.records if r.time > 0.0]
    first, last = min(times), max(times)
    if not last > first:
        return HandedOn(field="viscosity", part=None, remarks=("no relaxation spectrum: one time only",))
    if found.amplitude < 0.0:
        text = "no relaxation spectrum: the beam stiffens with time"
        return HandedOn(field="viscosity", part=None, remarks=(text,))
    return viscosity_of(lambda t: 1.0 - found.amplitude * np.log10(t), first=first, last=last)


CREEP = OutlineEffect(
    effect=catalogue.CREEP,
    step=0.01,
    bounds=(-0.15, 0.25),
    prior_scale=0.1,
    bend=_bend_creep,
    timed=True,
    hands_on=_viscosity_creep,
)
