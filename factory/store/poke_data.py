"""All data of one poke of a dataset, as a reader gets them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim import Inclusion


@dataclass(frozen=True, eq=False, kw_only=True)
class PokeData:
    """One poke: f frames, n surface nodes, t triangles.

    Attributes
    ----------
    index : int
    shape, level : str
        Names of the inclusion and of the material level.
    status, message : str
        Reason why the simulation ended.
    block : (float, float, float)
        Sides of the block along x, y and z [m].
    inclusion : Inclusion
        The rigid inclusion [m].
    direction : ndarray, shape (3,)
        Unit vector of the push.
    depth : ndarray, shape (f,)
        Travel of the indenter since first touch [m].
    rod_tip : ndarray, shape (f, 3)
        Centre of the indenter's tip [m].
    rod_force, base_force : ndarray, shape (f, 3)
        Force of the tissue on the indenter, and of the fixed nodes on the tissue [N].
    grid : ndarray, shape (f, 32, 32, 3)
        Positions of the grid on the top [m].
    surface : ndarray, shape (f, n, 3)
        Positions of the surface nodes [m]; `surface_rest`, shape (n, 3), before deformation.
    triangles : ndarray, shape (t, 3)
        Outward triangles of surface nodes.
    profile : ndarray of uint8, shape (32, 32, 128)
        Stiffness under each grid point, 255 x code.
    time : ndarray, shape (f,), or None
        Time since first touch [s]; None, like the following fields, if the recipe has no course.
    phase : tuple of str, length f, or None
        "load", "hold", "retract", "reload" or "rest".
    rod_speed : ndarray, shape (f,), or None
        Rate of change of the depth [m/s].
    dissipated_energy : ndarray, shape (f,), or None
        Energy that the material has lost since first touch [J].
    """

    index: int
    shape: str
    level: str
    status: str
    message: str
    block: tuple[float, float, float]
    inclusion: Inclusion
    direction: NDArray[np.float64]
    depth: NDArray[np.float64]
    rod_tip: NDArray[np.float64]
    rod_force: NDArray[np.float64]
    base_force: NDArray[np.float64]
    grid: NDArray[np.float64]
    surface: NDArray[np.float64]
    surface_rest: NDArray[np.float64]
    triangles: NDArray[np.int32]
    profile: NDArray[np.uint8]
    time: NDArray[np.float64] | None = None
    phase: tuple[str, ...] | None = None
    rod_speed: NDArray[np.float64] | None = None
    dissipated_energy: NDArray[np.float64] | None = None
