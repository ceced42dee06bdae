"""Quantity of a column, by its name and unit: machines name the same thing in many words."""

from __future__ import annotations

import re
import unicodedata
from typing import Literal, get_args

from calibration.lab_files._units import Unit

Quantity = Literal[
    "time", "displacement", "force", "strain", "stress", "stretch", "true-strain", "true-stress"
]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)

DIMENSIONS: dict[Quantity, str] = {
    "time": "time",
    "displacement": "length",
    "force": "force",
    "strain": "ratio",
    "stress": "stress",
    "stretch": "ratio",
    "true-strain": "ratio",
    "true-stress": "stress",
}

# Columns of the same words that are no record of a test: rates, set values, results, oscillation.
_NOT = re.compile(
    r"\bdate\b|\bat\b|break|maximum|minimum|constant|strain ratio"
    r"|rates?\b|speed|velocity|geschw|modul|energy|arbeit|work|cycle|target|set ?point|oscillat|amplitude"
    r"|normal stress|torque|temperature|count|index|viscosity|compliance|frequency|vorlauf|lateral"
    r"|transverse|quer"
)
# English, German and French words of Bluehill, testXpert, TRIOS and Mach-1 Motion. The first line that fits
# the name, and the unit if there is one, decides; without a unit a line of two quantities decides nothing.
_WORDS: tuple[tuple[re.Pattern[str], tuple[Quantity, ...]], ...] = (
    (re.compile(r"\btime\b|\bzeit\b|pruefzeit|prufzeit|testzeit|\btemps\b|\bdauer\b"), ("time",)),
    (re.compile(r"\bstretch\b|(elongation|extension) ratio|\blambda\b|\bλ\b"), ("stretch",)),
    (re.compile(r"stress|spannung|contrainte"), ("stress",)),
    (re.compile(r"strain"), ("strain",)),
    (
        re.compile(r"dehnung|stauchung|deformation|allongement|elongation|verformung"),
        ("strain", "displacement"),
    ),
    # before displacement: "Compression force", "Indentation load"
    (
        re.compile(r"force\b|\bload\b|kraft\b|\bf[xyz]?\b|\bcharge\b|\blast\b"),
        ("force",),
    ),
    (
        re.compile(
            r"extension|displacement|position|crosshead|travers|stroke|travel|\bweg\b|standardweg|deplacement"
            r"|\bdepth\b|indentation|compression\b|\bgap\b|tiefe|hub\b"
        ),
        ("displacement",),
    ),
)


# Words that say of which measure a strain or a stress is, before it, behind it, or in brackets.
_TRUE = re.compile(r"\b(true|wahre[rsn]?|vraie?s?)\b")
_TRUE_STRAIN = re.compile(r"\b(log|logarithmi\w*|hencky|naturelle|natural(?! rubber)|ln)\b")
_TRUE_STRESS = re.compile(r"\bcauchy\b")
_STRAIN, _STRESS = re.compile(r"strain|dehnung|deformation"), re.compile(r"stress|spannung|contrainte")
# Measures of large strain that no record is read in: neither nominal nor true.
_OTHER = re.compile(
    r"\b(green|lagrang\w*|almansi|euler\w*|biot|piola|kirchhoff|pk2|second|2nd|zweite[rsn]?)\b"
)
_NOMINAL = re.compile(r"\b(first|1st|pk1|erste[rsn]?|premier)\b")


def plain(name: str) -> str:
    """Lower case, without accents."""
    text = unicodedata.normalize("NFKD", name.replace("ß", "ss"))
    return " ".join(
        "".join(c for c in text if not unicodedata.combining(c)).lower().replace("_", " ").split()
    )


def quantity(name: str, unit: Unit | None) -> Quantity | None:
    """The quantity of a column; None where its name says none, or says two that its unit does not decide.

    Parameters
    ----------
    name : str
        Header without its unit.
    unit : Unit, optional
    """
    text = plain(name)
    if _NOT.search(text):
        return None
    if _OTHER.search(text) and not _NOMINAL.search(text):
        return None
    true = _true(text)
    if true is not None:
        return true if unit is None or unit.dimension == DIMENSIONS[true] else None
    # the source of a strain in brackets, as in "Tensile strain (Extension)", does not name the column
    text = re.sub(r"\([^()]*\)", "", text).strip() or text
    for pattern, candidates in _WORDS:
        if not pattern.search(text):
            continue
        if unit is None:
            return candidates[0] if len(candidates) == 1 else None
        fitting = [q for q in candidates if DIMENSIONS[q] == unit.dimension]
        if fitting:
            return fitting[0]
        if text == "extension" and unit.dimension == "ratio":
            return "strain"
    return None


def _true(text: str) -> Quantity | None:
    """True strain or true stress, where a name says so in any order."""
    if _STRAIN.search(text) and (_TRUE.search(text) or _TRUE_STRAIN.search(text)):
        return "true-strain"
    if _STRESS.search(text) and (_TRUE.search(text) or _TRUE_STRESS.search(text)):
        return "true-stress"
    return None


def pulls(name: str) -> bool | None:
    """True if positive values of a column of displacement or strain are a pull, False if a push; None if
    its name does not state it."""
    text = plain(name)
    if re.search(r"compress|stauch|druck|depth|indentation|tiefe", text):
        return False
    if re.search(r"tensile|extension|elongation|allongement|zug|strain|dehnung|stretch", text):
        return True
    return None
