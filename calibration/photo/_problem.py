"""A photograph that cannot be used: one sentence, and a picture of what was found."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError

Picture = NDArray[np.uint8]


class PhotoProblem(InputError):  # noqa: N818 - a fault of the photograph, not of the program
    """One sentence; picture: the photograph with what was found drawn in, (height, width, 3) BGR, or None."""

    def __init__(self, sentence: str, picture: Picture | None = None) -> None:
        super().__init__(sentence)
        self.picture = picture
