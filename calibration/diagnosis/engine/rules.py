"""How sure a search has to be, and how far it looks."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Rules:
    """Levels and limits of a search.

    Attributes
    ----------
    false_alarm_rate : probability of naming a cause where there is none.
    extra_cause_rate : probability of naming one cause too many.
    lack_of_fit_level : p-value below which what a fit leaves of the residuals counts as unexplained.
    score_tolerance : explanations within this of the best score (chi-square) are equivalent.
    rival : so are those that would be ranked first in this part of the replicates: a name is given alone
        where other noise would give it nine times in ten.
    shortlist : effects that are confirmed in the simulator.
    pairs : pairs of causes that are confirmed.
    max_causes : causes that are named together, where the model allows as many.
    triples : pairs that a third cause is looked for beside, and thirds of each that are confirmed.
    seed : of the bootstrap.
    draws : replicates of the bootstrap over specimens, tests or stretches of records.
    least_share : of the explainable misfit that causes must take to be named where more than noise is left: a
        cause beside an equally large one that is not in the library takes one half, more or less.
    surely, sure : share that they must take in this part of the replicates; the same part is asked of the
        draws of held-out parts.
    least_skill : of what noise leaves to explain in held-out measurements, that they must predict.
    least_share_within : of the share, as surely, where measurements can only be held out from within a test:
        what all of one test shares, a smooth error that nobody stated among it, is then in the training too.
    further_share : that one cause more must take.
    as_good, alike : part of the replicates in which another explanation may take more before it is named as
        well; share by which it must take less.
    same_amplitude : fraction of an amplitude, or `same_sds` of its standard deviations, by which it may
        change from fold to fold.
    tries : explanations whose held-out skill is measured, before none is named.
    smooth_error : part of full scale that a smooth error which nobody stated may have: a departure of the
        baseline below it is not named where the noise is not known.
    negligible : part of full scale below which what is left does not matter in practice.
    """

    false_alarm_rate: float = 0.02
    extra_cause_rate: float = 0.003
    lack_of_fit_level: float = 0.005
    score_tolerance: float = 6.0
    rival: float = 0.1
    shortlist: int = 7
    pairs: int = 5
    max_causes: int = 3
    triples: tuple[int, int] = (2, 3)
    seed: int = 0
    draws: int = 400
    least_share: float = 0.4
    surely: float = 0.1
    sure: float = 0.95
    least_skill: float = 0.4
    least_share_within: float = 0.75
    further_share: float = 0.1
    as_good: float = 0.05
    alike: float = 0.02
    same_amplitude: float = 0.5
    same_sds: float = 3.0
    tries: int = 5
    smooth_error: float = 0.01
    negligible: float = 0.01
