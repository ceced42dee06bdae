"""What a diagnosis says, in words for people."""

from __future__ import annotations

from calibration.diagnosis._rig_file import corrects
from calibration.diagnosis.engine.null import EVERYTHING
from calibration.diagnosis.engine.search import Finding
from calibration.measurements._baseline import SPECIMENS
from calibration.measurements._effect import EffectModel, Owner
from calibration.pages import significant

SUSPECT = 0.005  # a chance below is no accident

MEANING: dict[Owner, str] = {
    "specimen": "a property of the specimen: it may enter a simulated dataset",
    "rig": "a fault of the rig: it corrects the calibration, and must not enter a simulated dataset",
    "camera": "a fault of the camera: it corrects the calibration, and must not enter a simulated dataset",
    "simulator": "a fault of the simulator: cure it there; it must not enter a simulated dataset",
}

UNREAD = (
    "a fault of the {}: this calibration allows for it, later ones do not (rig.yaml is a record); it must not"
    " enter a simulated dataset"
)

HEADLINE = {
    "none": "No cause to name",
    "found": "Cause found",
    "ambiguous": "Several causes would explain this",
    "partly explained": "Explained in part",
    "unexplained": "Departure without a known cause",
}

_PATTERNS = {
    EVERYTHING: "size of all residuals together",
    SPECIMENS: "moduli that differ between specimens of one material by more than a lab's scatter",
}
_OF_KIND = {
    "outlines": {
        "trial edges": "bends of single edges that all photographs of a trial share",
        "trial bends": "bends of the whole beam that all photographs of a trial share",
        "support bends": "bends that beams of one length and support share",
        "drifts": "bends that grow with the logarithm of time",
    },
    "homogeneous": {
        "trial bends": "smooth bends of a test's curve",
        "mode bends": "smooth bends that tests of one mode and material share",
        "loops": "differences between loading and unloading",
        "drifts": "drifts of a test in time",
        "cycles": "shifts from one stroke to the next",
        "jumps": "steps within a test",
    },
    "indentation": {
        "trial bends": "smooth bends of a test's curve",
        "phase bends": "smooth bends of single phases",
        "drifts": "drifts of a test in time",
        "shared bends": "smooth bends that tests of a specimen share",
    },
}
_OF_KIND["compression"] = _OF_KIND["homogeneous"]


def pattern(name: str, kind: str) -> str:
    """A set of patterns for people, in the words of a kind of measurement; what that kind calls it where it
    is not known here."""
    return _PATTERNS.get(name) or _OF_KIND.get(kind, {}).get(name, name)


def headline(finding: Finding) -> str:
    """The verdict in a few words."""
    if finding.verdict == "ambiguous" and finding.certain:
        return "A cause found, and one more that cannot be told"
    return HEADLINE[finding.verdict]


def meaning(effect: EffectModel) -> str:
    """What it means that an effect belongs where it does."""
    if effect.belongs_to in ("rig", "camera") and corrects([effect]) == "nothing":
        return UNREAD.format(effect.belongs_to)
    return MEANING[effect.belongs_to]


def scope(at: str) -> str:
    return "all measurements" if at == "all" else at


def p_text(p: float, draws: int) -> str:
    """A chance to two digits; what the bootstrap cannot resolve, as a bound."""
    finest = 1.0 / (draws + 1)
    if p <= 1.001 * finest:
        return f"≤ {significant(finest, 2)}"
    return significant(p, 2)


def tiny(p: float) -> str:
    """A chance that may be extrapolated far below what was drawn."""
    return significant(p, 2) if p >= 1e-4 else (f"{p:.0e}" if p > 0.0 else "below 1e-300")
