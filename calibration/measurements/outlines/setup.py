"""How trials really stood before the camera, where that is known to differ from what the lab says."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import BeamTrial
from tisim import Beam

Array = NDArray[np.float64]


class Setup(Protocol):
    """What is known of a rig and its camera. It has to go through pickle, since fits run in processes.

    digest: sha256 of what it says. sentence: it in words, for cards and reports.
    """

    @property
    def digest(self) -> str: ...

    @property
    def sentence(self) -> str: ...

    def bend(self, beam: Beam, trial: BeamTrial) -> Beam:
        """The scene of a trial as its rig really holds it."""

    def image(self, points: Array, trial: BeamTrial) -> Array:
        """Where the trial's photographs show points of the scene, (k, 2) of x, z [m]."""

    def doubts(self) -> Sequence[tuple[str, Setup]]:
        """The same setup one standard deviation off, by a name, for each independent direction."""
