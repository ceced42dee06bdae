"""Which effects each kind of measurement has.

A new effect is one file with its description and its action, and one registration::

    SOAKED = Effect(name="soaked", parameter="water_percent", per_unit=100.0, ...)
    register("homogeneous", HomogeneousEffect(effect=SOAKED, step=1e-3, bounds=(0.0, 0.5), factor=...))
"""

from __future__ import annotations

from importlib import import_module

from calibration.measurements._effect import EffectModel

# Kinds whose effects stand in `calibration.diagnosis.effects`, imported when asked for.
_OWN = ("outlines", "homogeneous", "compression", "indentation", "release")
_ADDED: dict[str, dict[str, EffectModel]] = {}

# Names that effects of a kind had in earlier versions, where one name meant two things; read in files.
ALIASES: dict[str, dict[str, str]] = {
    "compression": {"platen-friction": "platen-bonding", "force-offset": "stress-offset"},
    "release": {"radius": "section-scale", "relaxation-branch": "relaxation"},
}

# Names that parameters of an effect had in earlier versions, by the effect's name now. `part_of_modulus` was
# a fraction of a vibration's modulus: the same but for times near its period.
PARAMETERS: dict[str, dict[str, str]] = {
    "relaxation": {"loss": "fraction_of_modulus", "part_of_modulus": "fraction_of_modulus"},
}


def register(kind: str, effect: EffectModel) -> None:
    """Add an effect to a kind of measurement. ValueError where the kind has one of that name."""
    if effect.name in effects_of(kind):
        raise ValueError(f"effect {effect.name}: {kind} has one of that name")
    _ADDED.setdefault(kind, {})[effect.name] = effect


def unregister(kind: str, name: str) -> None:
    """Take away an effect that was added."""
    del _ADDED[kind][name]


def effects_of(kind: str) -> dict[str, EffectModel]:
    """All effects of a kind by name, in the order in which a search lists them."""
    own: dict[str, EffectModel] = {}
    if kind in _OWN:
        own = import_module(f"calibration.diagnosis.effects.{kind}").EFFECTS
    return {**own, **_ADDED.get(kind, {})}


def true_name(kind: str, name: str) -> str:
    """The name of an effect now, of one that it may have had in an earlier version."""
    return ALIASES.get(kind, {}).get(name, name)


def true_parameter(effect: str, name: str) -> str:
    """The name of an effect's parameter now, of one that it may have had in an earlier version."""
    return PARAMETERS.get(effect, {}).get(name, name)
