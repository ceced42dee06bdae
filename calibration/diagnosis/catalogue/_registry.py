"""Registry of the effects of each kind of measurement.

A new effect needs one file with its description and its model, and one registration::

    SOAKED = Effect(name="soaked", parameter="water_percent", per_unit=100.0, ...)
    register("homogeneous", HomogeneousEffect(effect=SOAKED, step=1e-3, bounds=(0.0, 0.5), factor=...))
"""

from __future__ import annotations

from importlib import import_module

from calibration.measurements._effect import EffectModel

# Kinds whose effects are in `calibration.diagnosis.effects`, imported on first use.
_OWN = ("outlines", "homogeneous", "compression", "indentation", "release")
_ADDED: dict[str, dict[str, EffectModel]] = {}

# Earlier names of effects by kind, from when one name had two meanings; still read in files.
ALIASES: dict[str, dict[str, str]] = {
    "compression": {"platen-friction": "platen-bonding", "force-offset": "stress-offset"},
    "release": {"radius": "section-scale", "relaxation-branch": "relaxation"},
}

# Earlier names of parameters, by the effect's current name. `part_of_modulus` was relative to the storage
# modulus of the vibration: equal except for relaxation times near its period.
PARAMETERS: dict[str, dict[str, str]] = {
    "relaxation": {"loss": "fraction_of_modulus", "part_of_modulus": "fraction_of_modulus"},
}


def register(kind: str, effect: EffectModel) -> None:
    """Add an effect to a kind of measurement, by its current or an earlier name.

    ValueError if there is no such kind (register one's own first), or it has an effect of that name.
    """
    from calibration.measurements._kinds import true_kind

    kind = true_kind(kind)
    if effect.name in effects_of(kind):
        raise ValueError(f"effect {effect.name}: {kind} has one of that name")
    _ADDED.setdefault(kind, {})[effect.name] = effect


def unregister(kind: str, name: str) -> None:
    """Remove an effect that was added with `register`."""
    del _ADDED[kind][name]


def effects_of(kind: str) -> dict[str, EffectModel]:
    """All effects of a kind by name, in the order used by a search."""
    own: dict[str, EffectModel] = {}
    if kind in _OWN:
        own = import_module(f"calibration.diagnosis.effects.{kind}").EFFECTS
    return {**own, **_ADDED.get(kind, {})}


def true_name(kind: str, name: str) -> str:
    """Current name of an effect, from its current or an earlier name."""
    return ALIASES.get(kind, {}).get(name, name)


def true_parameter(effect: str, name: str) -> str:
    """Current name of an effect's parameter, from its current or an earlier name."""
    return PARAMETERS.get(effect, {}).get(name, name)
