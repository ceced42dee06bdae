"""Which effects may sit where in an experiment's beams."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from calibration.diagnosis.beams.effects import BeamEffect
from calibration.diagnosis.effect import Candidate
from calibration.experiment.model import BeamTrial


def candidates_of(trials: Sequence[BeamTrial], effects: Mapping[str, BeamEffect]) -> tuple[Candidate, ...]:
    """Each effect in all trials, in those of one material, and in one specimen, where these differ; effects
    that sit in one trial alone only there. A camera's and a simulator's faults are in all."""
    found: list[Candidate] = []
    for effect in effects.values():
        touched = [t for t in trials if effect.touches(t)]
        if not touched:
            continue
        if effect.belongs_to == "simulator":
            found.append(Candidate(effect=effect.name))  # one simulator made them all
            continue
        for place in effect.places:
            if effect.reach == "trial":
                for t in touched:
                    found.append(
                        Candidate(
                            effect=effect.name, at=t.id, place=place, rivals=len(touched) * len(effect.places)
                        )
                    )
                continue
            if effect.belongs_to == "camera":
                found.append(Candidate(effect=effect.name, place=place))
                continue
            groups: list[tuple[str, ...]] = [tuple(t.id for t in touched)]
            found.append(Candidate(effect=effect.name, place=place))
            for names in ([t.material for t in touched], [t.specimen or t.material for t in touched]):
                distinct = list(dict.fromkeys(names))
                for name in distinct:
                    members = tuple(t.id for t, n in zip(touched, names, strict=True) if n == name)
                    if members not in groups:  # one material, or one specimen a material, adds nothing
                        groups.append(members)
                        found.append(
                            Candidate(effect=effect.name, at=name, place=place, rivals=len(distinct))
                        )
    return tuple(found)


def reaches(candidate: Candidate, trial: BeamTrial, effect: BeamEffect) -> bool:
    """Whether a candidate is in a trial."""
    named = candidate.at in ("all", trial.id, trial.material, trial.specimen)
    return named and effect.touches(trial)
