"""A folder of measurements, format 1, read and checked."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from calibration.experiment._beam import BeamEntry, read_beam
from calibration.experiment._coupon import CouponEntry, read_coupon
from calibration.experiment._fields import Name, Strict, below, different_ids, different_materials, say
from calibration.experiment._files import MAIN, Files
from calibration.experiment._poke import PokeEntry, read_poke
from calibration.experiment._yaml import parse
from calibration.experiment.model import Experiment, MaterialBelief, Trial, specimen_of

# kg/m3: outside of it a density is one in g/cm3 or a slip
_LIGHTEST, _HEAVIEST = 10.0, 30_000.0


class MaterialEntry(Strict):
    """A material as the lab believes."""

    softener_ratio: Annotated[float, Field(ge=0, le=100)] | None = None
    density_kg_m3: Annotated[float, Field(gt=0)] | None = None
    density_sd_kg_m3: Annotated[float, Field(ge=0)] = 0.0

    @model_validator(mode="after")
    def _density(self) -> MaterialEntry:
        density = self.density_kg_m3
        if density is None:
            if self.density_sd_kg_m3 > 0:
                raise say("density_kg_m3", "missing, expected it beside density_sd_kg_m3")
            return self
        if not _LIGHTEST <= density <= _HEAVIEST:
            raise say("density_kg_m3", f"expected {_LIGHTEST:g} to {_HEAVIEST:g} kg/m3, got {density:g}")
        below("density_sd_kg_m3", self.density_sd_kg_m3, "density_kg_m3", density)
        return self


def _whole(value: object) -> object:
    """`true` equals 1 in Python, not in a file."""
    return str(value).lower() if isinstance(value, bool) else value


TrialEntry = Annotated[BeamEntry | PokeEntry | CouponEntry, Field(discriminator="kind")]


class ExperimentEntry(Strict):
    """experiment.yaml."""

    format: Annotated[Literal[1], BeforeValidator(_whole)]
    name: Annotated[str, Field(min_length=1, max_length=200)]
    notes: str = ""
    materials: Annotated[dict[Name, MaterialEntry], Field(min_length=1)]
    trials: Annotated[tuple[TrialEntry, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _names(self) -> ExperimentEntry:
        different_ids(self.trials)
        different_materials(self.materials)
        for k, trial in enumerate(self.trials):
            if trial.material not in self.materials:
                known = ", ".join(self.materials)
                raise say(
                    f"trials.{k}.material", f"expected a name of materials ({known}), got {trial.material!r}"
                )
        return self


def read(folder: Path, *, leave_out_rows: bool = False) -> Experiment:
    """The experiment of a folder that holds experiment.yaml (format 1), in SI.

    Each file that it names is read and checked. An outline's sides are (k, 2) arrays from the clamp on: a
    side traced towards the clamp is turned round, otherwise the order stays as it came. A poke's direction
    comes out with length 1. Standard deviations of nominal values (density, section, free length, depth,
    stretch) are 0 where left out; those of an outline (outline_sd_mm, outline_correlation_mm, registration_sd
    with all of its keys), of markers and of scanned points must be given.

    Raises InputError, one sentence that names the file, the key or line, and what was expected. In it, trials
    go by their id and other lists count from 1: `trials[NAME].captures[#2].time_s`.

    leave_out_rows : rows of homogeneous tests at which the clock runs backwards are left out, in place of an
    error; the experiment's notes say which.
    """
    files = Files(Path(folder), leave_out_rows=leave_out_rows)
    entry = parse(files.read(MAIN, ""), files.main, ExperimentEntry)
    trials = _told_apart(tuple(_trial(trial, files) for trial in entry.trials))
    materials = {
        name: MaterialBelief(
            name=name,
            softener_ratio=belief.softener_ratio,
            density=belief.density_kg_m3,
            density_sd=belief.density_sd_kg_m3,
        )
        for name, belief in entry.materials.items()
    }
    return Experiment(
        name=entry.name,
        folder=files.folder,
        notes="\n".join([entry.notes, *files.left_out]).strip(),
        materials=MappingProxyType(materials),
        trials=trials,
        digest=files.digest(),
    )


def _told_apart(trials: tuple[Trial, ...]) -> tuple[Trial, ...]:
    """The trials; specimens of two materials that have one name get their material's before it."""
    materials: dict[str, set[str]] = {}
    for t in trials:
        materials.setdefault(specimen_of(t), set()).add(t.material)
    shared = {name for name, owners in materials.items() if len(owners) > 1}
    return tuple(
        replace(t, specimen=f"{t.material} {t.specimen}") if t.specimen in shared else t for t in trials
    )


def _trial(entry: BeamEntry | PokeEntry | CouponEntry, files: Files) -> Trial:
    where = f"trials[{entry.id}]"
    if isinstance(entry, BeamEntry):
        return read_beam(entry, files, where)
    if isinstance(entry, PokeEntry):
        return read_poke(entry, files, where)
    return read_coupon(entry, files, where)
