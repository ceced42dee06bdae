"""Wording of verdicts, tests and p-values on the page of a diagnosis."""

from __future__ import annotations

from calibration.diagnosis._rig_file import corrects
from calibration.diagnosis.engine.null import EVERYTHING
from calibration.diagnosis.engine.search import Finding
from calibration.measurements._baseline import SPECIMENS
from calibration.measurements._effect import EffectModel, Owner
from calibration.pages import significant

SUSPECT = 0.005  # p-value below which a test counts as failed

MEANING: dict[Owner, str] = {
    "specimen": "a property of the specimen: it may enter a simulated dataset",
    "rig": "a fault of the rig: it corrects the calibration, and must not enter a simulated dataset",
    "camera": "a fault of the camera: it corrects the calibration, and must not enter a simulated dataset",
    "simulator": "a fault of the simulator: correct it there; it must not enter a simulated dataset",
}

UNREAD = (
    "a fault of the {}: this calibration corrects for it, later ones do not (rig.yaml is a record); it must"
    " not enter a simulated dataset"
)

HEADLINE = {
    "none": "No cause",
    "found": "Cause found",
    "ambiguous": "Several equivalent explanations",
    "partly explained": "Partly explained",
    "unexplained": "Unexplained misfit",
}

_PATTERNS = {
    EVERYTHING: "sum of squares of all residuals",
    SPECIMENS: "moduli that differ between specimens of one material by more than a lab's scatter",
}
_OF_KIND = {
    "outlines": {
        "trial edges": "smooth residuals of single edges, common to all photographs of a trial",
        "trial bends": "smooth residuals of the whole beam, common to all photographs of a trial",
        "support bends": "smooth residuals common to beams of one length and support",
        "drifts": "smooth residuals that grow with the logarithm of time",
    },
    "homogeneous": {
        "trial bends": "smooth residuals of a test's curve",
        "mode bends": "smooth residuals common to tests of one mode and material",
        "loops": "differences between loading and unloading",
        "drifts": "drifts of a test in time",
        "cycles": "shifts from one stroke to the next",
        "jumps": "steps within a test",
    },
    "indentation": {
        "trial bends": "smooth residuals of a test's curve",
        "phase bends": "smooth residuals of single phases",
        "drifts": "drifts of a test in time",
        "shared bends": "smooth residuals common to tests of a specimen",
    },
}
_OF_KIND["compression"] = _OF_KIND["homogeneous"]


def pattern(name: str, kind: str) -> str:
    """Description of a set of the discrepancy basis for a kind of measurement; its name if it has none."""
    return _PATTERNS.get(name) or _OF_KIND.get(kind, {}).get(name, name)


def headline(finding: Finding) -> str:
    """Title of the verdict."""
    if finding.verdict == "ambiguous" and finding.certain:
        several = "One cause" if len(finding.certain) == 1 else "Several causes"
        return f"{several} found, another not identified"
    return HEADLINE[finding.verdict]


def meaning(effect: EffectModel) -> str:
    """Consequence of the effect's owner (specimen, rig, camera or simulator) for calibration and datasets."""
    if effect.belongs_to in ("rig", "camera") and corrects([effect]) == "nothing":
        return UNREAD.format(effect.belongs_to)
    return MEANING[effect.belongs_to]


def scope(at: str) -> str:
    return "all measurements" if at == "all" else at


def p_text(p: float, draws: int) -> str:
    """A p-value to two digits; one that the bootstrap cannot resolve, as a bound."""
    finest = 1.0 / (draws + 1)
    if p <= 1.001 * finest:
        return f"≤ {significant(finest, 2)}"
    return significant(p, 2)


def tiny(p: float) -> str:
    """A p-value that may be extrapolated far below the resolution of the draws."""
    return significant(p, 2) if p >= 1e-4 else (f"{p:.0e}" if p > 0.0 else "below 1e-300")
