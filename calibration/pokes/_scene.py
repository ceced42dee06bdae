"""A measured poke as a scene: where it touches, how deep its record counts from there."""

from __future__ import annotations

from calibration.errors import InputError
from calibration.experiment.model import PokeTrial
from tisim import Material, Poke, Rod

# A start this close to the top counts as on it [m].
ON_TOP = 1e-5
# Radius of a flat rod's round edge over the rod's: the data format does not give it; that of `tisim.Rod`.
EDGE = 0.4


def approach(trial: PokeTrial) -> float:
    """Travel from the start to first touch [m]: 0 for a start on the block's top, where depth counts from
    first touch; above it, the way along the axis to the top. InputError for a start inside the block."""
    above = trial.start[2] - trial.block.size[2]
    if above < -ON_TOP:
        raise InputError(
            f"trial {trial.id}: start_mm: expected a start on or above the block's top, got one"
            f" {-above * 1e3:.3g} mm below it"
        )
    return max(0.0, above) / abs(trial.direction[2]) if above > ON_TOP else 0.0


def poke_scene(
    trial: PokeTrial,
    material: Material,
    *,
    depth: float,
    friction: float = 0.6,
    refinement: float = 1.0,
    edge_radius: float | None = None,
) -> Poke:
    """The poke to `depth` [m] from first touch, its axis through the record's start.

    edge_radius [m] of a flat rod; None: 0.4 of the rod's radius. InputError for an inclusion given as a mesh,
    which a poke cannot take yet.
    """
    if trial.inclusion_mesh is not None:
        raise InputError(
            f"trial {trial.id}: inclusion.mesh: expected a sphere, box or cylinder; a mesh cannot be fitted"
        )
    way = (trial.start[2] - trial.block.size[2]) / abs(trial.direction[2])
    edge = EDGE * trial.rod_radius if edge_radius is None else edge_radius
    return Poke(
        material=material,
        site=(trial.start[0] + way * trial.direction[0], trial.start[1] + way * trial.direction[1]),
        direction=trial.direction,
        depth=depth,
        block=trial.block,
        rod=Rod(radius=trial.rod_radius, tip=trial.rod_tip, edge_radius=edge),
        friction=friction,
        frame_spacing=max(min(0.5e-3, depth / 6.0), 1e-5),
        refinement=refinement,
    )


def block_names(trial: PokeTrial) -> tuple[str, str]:
    """What people call the block of a trial: by its size, and with its material."""
    size = " x ".join(f"{1e3 * x:g}" for x in trial.block.size)
    return f"block {size} mm", f"{trial.material} block {size} mm"
