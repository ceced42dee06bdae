"""A measured experiment: experiment.yaml and its files, read, checked and in SI."""

from calibration.experiment._fields import Strict, say
from calibration.experiment._photographs import PHOTOGRAPHS, PhotoSettings, read_photo_settings
from calibration.experiment._read import read
from calibration.experiment._yaml import load, parse
from calibration.experiment.model import (
    BeamTrial,
    Capture,
    Checkerboard,
    CouponMode,
    CouponTrial,
    Experiment,
    Marker,
    MaterialBelief,
    PokeRecord,
    PokeTrial,
    Registration,
    Supports,
    SurfaceScan,
    TracedOutline,
    Trial,
    Vector,
)

__all__ = [
    "PHOTOGRAPHS",
    "BeamTrial",
    "Capture",
    "Checkerboard",
    "CouponMode",
    "CouponTrial",
    "Experiment",
    "Marker",
    "MaterialBelief",
    "PhotoSettings",
    "PokeRecord",
    "PokeTrial",
    "Registration",
    "Strict",
    "Supports",
    "SurfaceScan",
    "TracedOutline",
    "Trial",
    "Vector",
    "load",
    "parse",
    "read",
    "read_photo_settings",
    "say",
]
