"""What can be wrong with a simulation: effects, and the places where one may sit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Scope = Literal["specimen", "rig", "camera", "simulator"]


@dataclass(frozen=True, kw_only=True)
class Effect:
    """A physical cause, nested in the simulator by one amplitude; zero means that it is absent.

    name: as `shared` catalogues and reports write it. parameter: of the amplitude in files, its unit in the
    name; `per_unit` file units make one SI unit.
    belongs_to: the specimen, the rig, the camera or the simulator. Only what belongs to a specimen may enter
    a simulated dataset.
    step: of a finite difference; bounds: where it makes sense; plausible: what a careful lab may still have
    overlooked (all SI). Where the data would need more than that, they cannot see the effect.
    sentence: what it is, for people. remedy: what to do about it on the bench.
    ends: bounds where the physics itself ends (a surface that slides freely): an amplitude may stop there.
    starts: part of the way to its bounds that a fit may start at. simulated: its fit costs simulations.
    """

    name: str
    parameter: str
    per_unit: float
    belongs_to: Scope
    step: float
    bounds: tuple[float, float]
    plausible: float
    sentence: str
    remedy: str
    ends: tuple[float, ...] = ()
    starts: float = 0.6

    @property
    def simulated(self) -> bool:
        return True

    def in_file(self, amplitude: float) -> float:
        """The amplitude in the file's unit."""
        return amplitude * self.per_unit


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """An effect at a place: in all measurements, in those of one material, specimen or trial.

    at: "all" or the name. place: where in the specimen, for effects that have one (part of its length).
    rivals: among how many of its kind this scope was one choice: 1 for "all", 3 for one material of three.
    """

    effect: str
    at: str = "all"
    place: float | None = None
    rivals: int = 1

    @property
    def label(self) -> str:
        where = "" if self.at == "all" else f" of {self.at}"
        return self.effect + where + ("" if self.place is None else f" at {self.place:.0%}")
