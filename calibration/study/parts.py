"""Parts beside the law in a fit: which are asked for, whether the kinds of measurement follow them
(`calibration.measurements._over_time`), the choice among several.

Where the number of Prony terms is left to the data, one fit is made with each number, and the Bayesian
information criterion chooses (G. Schwarz, Ann. Stat. 6, 1978): it needs no further fit, where held-out
prediction takes one a fold, and it asks more of a term than Akaike's does, which errs towards too many terms
where records have hundreds of points.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import product
from typing import Any

import numpy as np

from calibration.errors import InputError, OptionError
from calibration.experiment.model import Experiment
from calibration.measurements._kinds import compared
from calibration.measurements._over_time import union
from calibration.parameters import (
    OPTIONS,
    Parametrisation,
    PartCoordinates,
    ProtocolWindow,
    held_part,
    long_time_parts,
    part_alternatives,
    part_coordinates,
    part_entry,
    part_kind,
    part_kinds,
)
from calibration.study.calibration import Calibration
from tisim.parts import Part

_ANY = ProtocolWindow(first=1.0, last=100.0, peaks=1)  # for the check of a spec alone


@dataclass(frozen=True)
class CardParts:
    """Parts of a material card beside its law, for a fit.

    A part is held as it is; if the fit searches one of its field, the search begins there.

    Attributes
    ----------
    name : str
        Name of the card, for messages.
    parts : mapping
        Parts by the field of `tisim.Material`.
    path : str
        File that it was read from, for the command that repeats a fit.
    """

    name: str
    parts: Mapping[str, Part]
    path: str = ""

    @property
    def content(self) -> dict[str, dict[str, Any]]:
        """Parts as a card states them."""
        return {field: part_entry(part) for field, part in self.parts.items()}

    def held(self, specs: Sequence[str]) -> dict[str, Part]:
        """Parts whose field the fit does not search, for the long-time moduli that a fit has."""
        searched = {option_of(s) for s in specs}
        return {field: part for field, part in self._long_time.items() if OPTIONS[field] not in searched}

    @property
    def _long_time(self) -> dict[str, Part]:
        return long_time_parts(self.parts)[0]

    def begun(self, part: PartCoordinates) -> PartCoordinates:
        """The coordinates searched from the card's part on; as they are where it is of another form."""
        own = self._long_time.get(part.field)
        if own is None:
            return part
        try:
            return part.starting_at(own)
        except ValueError:
            return part

    def sentence(self, specs: Sequence[str]) -> str:
        """Clauses on its parts: which are held, and at which a search begins."""
        held = self.held(specs)
        said = [
            f"{field} ({_in_words(part)}) is held as {self.name} states it" for field, part in held.items()
        ]
        for spec in specs:
            part = part_coordinates(spec, _ANY)
            if part.field in self.parts:
                begins = "began" if self.begun(part) is not part else "did not begin, for its other form,"
                said.append(f"the search of {part.label} {begins} at the {part.field} of {self.name}")
        if held:
            said.append("no error bar has the error of what is held")
        return "; ".join(said)


def _in_words(part: Part) -> str:
    """prony, fractions 0.3 and 0.2, times 1 and 20."""
    values = {f.name: getattr(part, f.name) for f in fields(part)}
    each = {name: v if isinstance(v, tuple) else (v,) for name, v in values.items()}
    return ", ".join([part.name, *(f"{name} {' and '.join(map(_word, v))}" for name, v in each.items())])


def _word(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"


def asked(**options: str | None) -> tuple[str, ...]:
    """Specs of the parts that options ask for (time="prony:2", damage="mullins").

    Raises
    ------
    OptionError
        An option names no part of its own, or an argument that the part does not take.
    """
    found = []
    for option, spec in options.items():
        if spec is None:
            continue
        usage = ", ".join(k.usage for k in part_kinds(option))
        try:
            kind = part_kind(spec)
            for alternative in part_alternatives(spec):
                part_coordinates(alternative, _ANY)
        except ValueError:
            raise OptionError(option, spec, f"expected {_one_of(usage)}") from None
        if kind.option != option:
            raise OptionError(option, spec, f"expected {_one_of(usage)}")
        found.append(spec)
    return tuple(found)


def option_of(spec: str) -> str:
    """The option that asks for a part."""
    return part_kind(spec).option


def _one_of(usage: str) -> str:
    return f"one of {usage}" if "," in usage else usage


def check(
    experiment: Experiment,
    materials: Sequence[str],
    specs: Sequence[str],
    cards: Mapping[str, CardParts] | None = None,
) -> None:
    """InputError, in one sentence, where a material's tests cannot be fitted with these parts, or not with
    those of its card."""
    for material in materials:
        _check(experiment, material, specs)
        card = (cards or {}).get(material)
        if card is None:
            continue
        try:
            _check(experiment, material, [part_kinds(OPTIONS[f])[0].name for f in card.held(specs)])
        except InputError as error:
            raise InputError(f"{card.name}: {error}") from None


def _check(experiment: Experiment, material: str, specs: Sequence[str]) -> None:
    if specs:
        for kind, own in compared(_of(experiment, material)):
            follows = None if kind.over_time is None else kind.over_time()
            for part in map(part_kind, specs):
                if follows is None or part.option not in follows.options:
                    why = "which is not fitted with it yet" if follows is None else follows.why_not
                    raise InputError(
                        f"trial {own.trials[0].id}: --{part.option}: expected no {kind.name}, {why}"
                    )
            assert follows is not None
            follows.check(own, specs)


def with_parts(
    law: Parametrisation,
    specs: Sequence[str],
    experiment: Experiment,
    material: str,
    card: CardParts | None = None,
) -> Parametrisation:
    """The law with parts that are fitted to a material's tests of all kinds; each spec says all.

    card : card of the material, whose parts are held, or begin the search.
    """
    held = {} if card is None else card.held(specs)
    if not specs and not held:
        return law
    window = union(
        [kind.over_time().window(own) for kind, own in compared(_of(experiment, material)) if kind.over_time]
    )
    if any(part_kind(s).needs_time for s in specs) and not window.last > 0.0:
        raise InputError(f"material {material}: expected records that last longer than 0 s")
    searched = [part_coordinates(s, window) for s in specs]
    if card is not None:
        searched = [card.begun(p) for p in searched]
    return law.with_parts([*searched, *(held_part(field, part, window) for field, part in held.items())])


def _of(experiment: Experiment, material: str) -> Experiment:
    return replace(experiment, trials=tuple(t for t in experiment.trials if t.material == material))


def label(law: str, specs: Sequence[str], card: CardParts | None = None) -> str:
    """Label of a fit, before its data are read."""
    held = {} if card is None else card.held(specs)
    own = [held_part(field, part, _ANY).label for field, part in held.items()]
    return "+".join([law, *(s.replace(":", "-") for s in specs), *own])


def alternatives(specs: Sequence[str]) -> list[tuple[str, ...]]:
    """All sets of specs among which the data choose."""
    return [*product(*(part_alternatives(s) for s in specs))]


def choose(results: Sequence[Calibration]) -> Calibration:
    """The fit with the lowest Bayesian information criterion, chi-square over the least reduced one, where
    that is above 1; its note says how far the others are."""
    fitted = [r for r in results if r.parameters]
    sound = [r for r in fitted if r.status in ("converged", "lack of fit")] or fitted
    if not sound:
        return results[0]
    scale = max(1.0, min(r.reduced_chi2 for r in sound))
    values = {r.label: r.chi2 / scale + len(r.u) * float(np.log(r.points)) for r in sound}
    best = min(sound, key=lambda r: values[r.label])
    others = ", ".join(
        f"{name} {value - values[best.label]:+.1f}" for name, value in values.items() if name != best.label
    )
    lost = [f"{r.label} {r.status}" for r in results if r not in sound]
    sentence = f"{best.label} has the lowest Bayesian information criterion"
    if others or lost:
        sentence += f" ({'; '.join(n for n in (others, *lost) if n)})"
    return replace(best, note="; ".join(n for n in (sentence, best.note) if n))
