"""Dimensions and densities of beams that the lab states with a standard deviation."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from calibration.experiment.model import BeamTrial, MaterialBelief, specimen_of
from tisim import Beam, Circle, Rectangle

Section = Circle | Rectangle
Quantity = Literal["radius", "width", "height", "length", "density"]

STEP = 0.005  # finite-difference step, relative to the quantity


@dataclass(frozen=True, kw_only=True)
class Admitted:
    """An uncertain quantity that trials share.

    Attributes
    ----------
    name : name of the nuisance.
    quantity : radius, width, height or length [m], or density [kg/m3].
    trials : indices of the trials.
    sd, step : standard deviation and finite-difference step, in the quantity's unit.
    """

    name: str
    quantity: Quantity
    trials: tuple[int, ...]
    sd: float
    step: float

    def moved(self, beam: Beam) -> Beam:
        """Beam with the quantity increased by one step."""
        if self.quantity == "length":
            return replace(beam, length=beam.length + self.step)
        if self.quantity == "density":
            return replace(beam, material=replace(beam.material, density=beam.material.density + self.step))
        size = getattr(beam.section, self.quantity) + self.step
        return replace(beam, section=replace(beam.section, **{self.quantity: size}))


def admitted(trials: Sequence[BeamTrial], belief: MaterialBelief) -> list[Admitted]:
    """Uncertain quantities (sd above 0) of one material's trials.

    One for each dimension of a specimen's section, each trial's free length, and the material's density.
    Trials of one specimen share a dimension if they state the same section: a batch may be cast into several.
    """
    found: list[Admitted] = []
    specimens: dict[tuple[str, Section, tuple[float, ...]], list[int]] = {}
    for i, t in enumerate(trials):
        specimens.setdefault((specimen_of(t), t.section, t.section_sd), []).append(i)
    several = Counter(name for name, _, _ in specimens)
    for (name, section, sds), members in specimens.items():
        of = name if several[name] == 1 else f"{name}, {', '.join(trials[i].id for i in members)}"
        sizes: tuple[Quantity, ...] = ("radius",) if isinstance(section, Circle) else ("width", "height")
        for quantity, sd in zip(sizes, sds, strict=False):
            if sd > 0.0:
                step = STEP * getattr(section, quantity)
                found.append(
                    Admitted(
                        name=f"{quantity} of {of}",
                        quantity=quantity,
                        trials=tuple(members),
                        sd=sd,
                        step=step,
                    )
                )
    for i, t in enumerate(trials):
        if t.free_length_sd > 0.0:
            step = STEP * t.free_length
            found.append(
                Admitted(
                    name=f"free length of {t.id}",
                    quantity="length",
                    trials=(i,),
                    sd=t.free_length_sd,
                    step=step,
                )
            )
    if belief.density_sd > 0.0 and belief.density is not None:
        found.append(
            Admitted(
                name=f"density of {belief.name}",
                quantity="density",
                trials=tuple(range(len(trials))),
                sd=belief.density_sd,
                step=STEP * belief.density,
            )
        )
    return found
