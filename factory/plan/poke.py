"""One poke of a plan: its scene, and where it stands among the others."""

from __future__ import annotations

from dataclasses import dataclass

from tisim import Poke


@dataclass(frozen=True, kw_only=True)
class PlannedPoke:
    """One poke to simulate.

    Attributes
    ----------
    index : int
        Index in the plan and in the store.
    shape, level : int
        Indices into the recipe's shapes and material levels.
    geometry : int
        shape * number of material levels + level.
    site : int
        Number of the contact point within its set.
    shared : bool
        True if the contact point is common to all material levels of the shape.
    seed : int
        Seed that contact point and direction were drawn from.
    scene : Poke
        Scene to simulate.
    solved_as : int
        Index of the earlier poke whose solve is reused, since the two differ only by a factor of the moduli
        (`factory.plan.shared_solves`); -1 if the poke is solved itself.
    force_factor : float
        Factor on the forces of that solve.
    """

    index: int
    shape: int
    level: int
    geometry: int
    site: int
    shared: bool
    seed: int
    scene: Poke
    solved_as: int = -1
    force_factor: float = 1.0

    @property
    def derived(self) -> bool:
        """True if it reuses another poke's solve."""
        return self.solved_as >= 0
