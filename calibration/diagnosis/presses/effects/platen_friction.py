"""The platens hold the end faces: the force is that of a free cylinder times (bonded over free) to the power
of the amplitude, both simulated (`tisim.Press`), so that 0 slides freely and 1 sticks all over.

Between the two this stands in for Coulomb friction: at small strain the ring that slips does not grow with
the load, since pressure and shear grow together, so that the amplitude is nearly constant along a record.
"""

from __future__ import annotations

from calibration.diagnosis.presses.effects._effect import PressEffect

MOST = 1.1  # a little beyond bonded: what is bonded is not at a bound, and simulated stresses have an error

EFFECT = PressEffect(
    name="platen-friction",
    parameter="part_of_bonded",
    per_unit=1.0,
    belongs_to="rig",
    step=1e-3,
    bounds=(0.0, MOST),
    ends=(MOST,),
    plausible=0.5,
    sentence="the platens hold the ends of the compressed cylinder by friction or adhesion",
    remedy="lubricate the platens and repeat, or press cylinders of two heights",
    holds=True,
    reach="rig",
)
