"""Position of the board behind photographed beams: an entry of photographs.yaml."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from calibration.experiment import PhotoSettings
from calibration.new._asking import above_zero, numbers
from calibration.new._trial import Work

WHERE = "photographs"
TOUCHES, SEEN = "touches", "seen"  # answers that leave a key out


def photo_settings(work: Work, given: PhotoSettings | None) -> dict[str, Any]:
    """Keys of photographs.yaml; further photographs of the board are copied.

    Raises
    ------
    InputError
        A photograph of the board is missing.
    """
    found = {} if given is None else given.model_dump(exclude_unset=True, exclude_none=True)
    asked: tuple[tuple[str, str, Callable[[str], Any], str, str], ...] = (
        (
            "board_distance_mm",
            "distance of the board from the beam's middle plane [mm]; "
            "'touches' where the beam's rear lies on it",
            above_zero,
            TOUCHES,
            "the beam's rear lies on the board",
        ),
        (
            "board_corner_mm",
            "x, z of the squares' lower left outer corner from the clamp's face and the beam's axis [mm]; "
            "'seen' where the photographs show the clamp's face",
            numbers(2),
            SEEN,
            "the photographs show the clamp's face",
        ),
    )
    for key, text, read, word, why in asked:
        value = work.settle(WHERE, key, found.get(key), text, _or(word, read), default=word, why=why)
        if value != word:
            found[key] = list(value) if isinstance(value, tuple) else value
    if "calibration_photos" in found:
        where = f"{WHERE}.calibration_photos"
        found["calibration_photos"] = [
            work.copy(work.source(name, where), "photos") for name in found["calibration_photos"]
        ]
    return found


def _or(word: str, read: Callable[[str], Any]) -> Callable[[str], Any]:
    return lambda text: text if text == word else read(text)
