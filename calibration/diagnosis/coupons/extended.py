"""A material of `tisim` with what a diagnosis of coupons found in it."""

from __future__ import annotations

from calibration.diagnosis.coupons._candidates import reaches
from calibration.diagnosis.coupons.model import CouponModel
from calibration.diagnosis.nested import State
from tisim import Material

BULK_RATIO = 300.0  # K/G, with which meshes cope: a coupon does not tell it


def extended_material(
    model: CouponModel, state: State, material: str, *, density: float = 1000.0
) -> Material:
    """The law with the state's effects on a material; density [kg/m3].

    Stiffening, a second invariant and a limited extensibility are laws of `tisim` where the baseline is
    Neo-Hookean; what belongs to the rig leaves the material as it is. ValueError, in one sentence, where
    `tisim` has no law for them: several at once, another baseline, an effect of time, history or direction.
    """
    record = next(r for r in model.records if r.material == material)
    amplitudes: dict[str, float] = {}
    for c, a in state.amplitudes.items():
        effect = model.effects[c.effect]
        if effect.belongs_to == "specimen" and reaches(c, record, effect):
            amplitudes[c.effect] = amplitudes.get(c.effect, 0.0) + a
    shear = model.shear_moduli(state.u)[material]
    if not amplitudes:
        return model.baseline.material(material, state.u, shear=shear, density=density)
    names = " and ".join(amplitudes)
    if len(amplitudes) > 1 or model.law != "neo-hookean":
        raise ValueError(f"{material}: there is no law for {names} beside {model.law}")
    ((name, a),) = amplitudes.items()
    bulk = BULK_RATIO * shear
    if name == "strain-stiffening":
        return Material(law="yeoh", parameters={"mu": shear, "stiffening": a, "bulk": bulk}, density=density)
    if name == "second-invariant":
        half = 0.5 * shear
        parameters = {"c10": half * (1.0 - a), "c01": half * a, "bulk": bulk}
        return Material(law="mooney-rivlin", parameters=parameters, density=density)
    if name == "limited-extensibility" and a > 0.0:
        chains = {"mu": shear, "locking": a**-0.5, "bulk": bulk}
        return Material(law="eight-chain", parameters=chains, density=density)
    raise ValueError(f"{material}: there is no law for {names}")
