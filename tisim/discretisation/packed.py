"""A material in the form that kernels read: compiled features, parameters, history of points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tisim import laws
from tisim.discretisation.history import History
from tisim.material import Material

if TYPE_CHECKING:
    from tisim.kernels.isochoric import Features

Array = NDArray[np.float64]


def features_of(material: Material) -> Features:
    """Parts of a material that its kernels compile in."""
    from tisim.kernels.isochoric import Features  # imports Taichi

    soft, fibres = material.softening, material.fibres
    return Features(
        viscous=material.viscosity is not None,
        softening=None if soft is None else soft.energy,
        softening_size=0 if soft is None else len(soft.pack()),
        fibres=None if fibres is None else fibres.energy,
        fibres_size=0 if fibres is None else len(fibres.pack()),
    )


def pack(material: Material) -> Array:
    """Parameters of a material's law, then those of its parts, in the order of `Features.tail_size`."""
    numbers = [laws.get(material.law).pack(material.parameters)]
    soft, fibres = material.softening, material.fibres
    if material.has_parts:
        numbers.append(np.ones(1))
    if soft is not None:
        numbers.append(soft.pack())
    if fibres is not None:
        numbers += [fibres.pack(), fibres.axis()]
    return np.ascontiguousarray(np.concatenate(numbers), dtype=np.float64)


def history_of(material: Material, points: tuple[int, int]) -> History | None:
    """History of points (m, q) at rest; None for a material without viscosity and softening."""
    viscosity = material.viscosity
    if viscosity is None and material.softening is None:
        return None
    return History(points, None if viscosity is None else viscosity.spectrum(), material.softening)
