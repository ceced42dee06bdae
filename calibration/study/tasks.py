"""The fits of a study: one task for each material and law, its measurements, and its place on disk."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from calibration.experiment import Experiment
from calibration.measurements._kinds import Kind, compared, is_added
from calibration.measurements.outlines.setup import Setup
from calibration.parameters import (
    added_coordinates,
    is_added_part,
    is_series,
    parametrisation,
    part_kind,
)
from calibration.study import parts
from calibration.study._store import FitStore
from calibration.study.calibrate import FitOptions
from calibration.study.measurements import Measurements, ObjectiveName, measurements
from calibration.study.parts import CardParts
from tisim import laws
from tisim.parallel.extensions import digest_of_code, is_own

# Raised whenever the objective or the search changes: their histories would not fit together.
FORMAT = 11


@dataclass(frozen=True, kw_only=True)
class Task:
    """One fit of a study.

    Attributes
    ----------
    experiment : Experiment
        Experiment as it was read, or as the caller changed it: trials left out, rows cut.
    material, law : str
    terms : int
        Number of terms of a series law.
    options : FitOptions
    folder : Path
        Folder of the fit, while it runs and after its end.
    objective : str
        "likelihood" or "dice".
    setup : Setup, optional
        Known setup of rig and camera.
    setup_file : str
        File that it was read from, for the command that repeats the fit.
    parts : tuple of str
        Parts of the material beside the law (`calibration.study.parts`).
    free_bulk_ratio : bool
        True if K/G is fitted to photographs, and not held.
    card : CardParts, optional
        Parts on the material's card, which are held or begin the search.
    """

    experiment: Experiment
    material: str
    law: str
    terms: int
    options: FitOptions
    folder: Path
    objective: ObjectiveName = "likelihood"
    setup: Setup | None = None
    setup_file: str = ""
    parts: tuple[str, ...] = ()
    free_bulk_ratio: bool = False
    card: CardParts | None = None

    @property
    def label(self) -> str:
        return parts.label(parametrisation(self.law, terms=self.terms).label, self.parts, self.card)

    @property
    def alternatives(self) -> list[Task]:
        """Fits among which the data choose; itself where there is no choice."""
        return [replace(self, parts=specs) for specs in parts.alternatives(self.parts)]

    @property
    def name(self) -> str:
        return f"{self.material}-{self.label}"

    @property
    def added_kinds(self) -> list[Kind]:
        """Kinds of measurement from outside the package whose trials it fits."""
        mine = [t for t in self.experiment.trials if t.material == self.material]
        found = compared(replace(self.experiment, trials=tuple(mine)))
        return [kind for kind, _ in found if is_added(kind)]

    @property
    def is_added(self) -> bool:
        """True if it needs something from outside the package, which other processes may not know."""
        law = laws.added(self.law) is not None or added_coordinates(self.law) is not None
        return law or any(map(is_added_part, self.parts)) or bool(self.added_kinds)

    def measurements(self, experiment: Experiment, *, workers: int | None) -> Measurements:
        """Measurement models of the experiment that it fits."""
        law = parts.with_parts(
            parametrisation(self.law, terms=self.terms), self.parts, experiment, self.material, self.card
        )
        return measurements(
            experiment,
            self.material,
            law,
            workers=workers,
            objective=self.objective,
            free_bulk_ratio=self.free_bulk_ratio,
        )

    def store(self) -> FitStore:
        header: dict[str, Any] = {
            "format": FORMAT,
            "data": self.experiment.digest,
            "trials": _content(self.experiment),
            "material": self.material,
            "law": self.label,
            "seed": self.options.cma.seed,
            "population": self.options.cma.population,
            "generations": self.options.cma.max_generations,
            "restarts": self.options.cma.restarts,
            "polish": self.options.gauss_newton,
            "objective": self.objective,
            "held_out": self.options.leave_one_out,
            "rig": None if self.setup is None else self.setup.digest,
        }
        if self.parts:
            header["parts"] = list(self.parts)
        added = laws.added(self.law)
        own = [*(() if added is None else vars(added).values()), *(part_kind(s).make for s in self.parts)]
        own += [added_coordinates(self.law)]
        own += [kind.load for kind in self.added_kinds]
        if any(callable(thing) and not is_own(thing) for thing in own):
            header["code"] = digest_of_code(*own)
        if self.card is not None:
            header["start"] = self.card.path
            header["card"] = self.card.content
        if self.free_bulk_ratio:
            header["free_bulk_ratio"] = True
        if self.setup_file:
            header["rig_file"] = self.setup_file
        return FitStore(self.folder, self.name, header)


def tasks_for(
    experiment: Experiment,
    *,
    law_names: Sequence[str],
    materials: Sequence[str],
    folder: Path,
    options: FitOptions | None = None,
    terms: int = 1,
    objective: ObjectiveName = "likelihood",
    setup: Setup | None = None,
    setup_file: str = "",
    specs: Sequence[str] = (),
    free_bulk_ratio: bool = False,
    cards: Mapping[str, parts.CardParts] | None = None,
) -> list[Task]:
    """Every law for every material, law by law, in the order given; specs : of parts beside each law; cards :
    by material, whose parts are held or begin the search."""
    return [
        Task(
            experiment=experiment,
            material=material,
            law=law,
            terms=terms if is_series(law) else 1,
            options=options or FitOptions(),
            folder=folder,
            objective=objective,
            setup=setup,
            setup_file=setup_file,
            parts=tuple(specs),
            free_bulk_ratio=free_bulk_ratio,
            card=(cards or {}).get(material),
        )
        for law in law_names
        for material in materials
    ]


def by_cost(names: Sequence[str]) -> list[str]:
    """Laws in the order in which fits of all are useful soonest: few constants first, and last the law that
    has no equilibrium in many trials and needs most steps in the others."""
    return sorted(
        names,
        key=lambda n: (n == "st-venant-kirchhoff", len(parametrisation(n).coordinates), n != "neo-hookean"),
    )


def _content(experiment: Experiment) -> str:
    """sha256 of trials and materials as they are fitted, which may be fewer than the files hold."""
    total = hashlib.sha256()

    def add(value: Any) -> None:
        if is_dataclass(value) and not isinstance(value, type):
            add([(f.name, getattr(value, f.name)) for f in fields(value)])
        elif isinstance(value, np.ndarray):
            total.update(f"{value.dtype}{value.shape}".encode() + np.ascontiguousarray(value).tobytes())
        elif isinstance(value, Mapping):
            add(list(value.items()))
        elif isinstance(value, list | tuple):
            total.update(f"({len(value)}".encode())
            for part in value:
                add(part)
        elif isinstance(value, Path):  # of a photograph; its content counts in the experiment's digest
            add(value.name)
        else:
            total.update(f"{type(value).__name__}:{value!r};".encode())

    add([experiment.materials, experiment.trials])
    return total.hexdigest()
