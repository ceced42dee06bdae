"""Setup of rig and camera as known from a rig file, if it differs from the lab's description."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import BeamTrial
from tisim import Beam

Array = NDArray[np.float64]


class Setup(Protocol):
    """Known setup of a rig and its camera. It must be picklable, since fits run in processes.

    Attributes
    ----------
    digest : SHA-256 of its content.
    sentence : description for cards and reports.
    """

    @property
    def digest(self) -> str: ...

    @property
    def sentence(self) -> str: ...

    def bend(self, beam: Beam, trial: BeamTrial) -> Beam:
        """Scene of a trial in the actual rig."""

    def image(self, points: Array, trial: BeamTrial) -> Array:
        """Positions in the trial's photographs of points of the scene, x, z [m], shape (k, 2)."""

    def doubts(self) -> Sequence[tuple[str, Setup]]:
        """Named setups that differ by one standard deviation, one for each independent direction."""
