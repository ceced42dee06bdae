"""Significance levels, thresholds and limits of a diagnosis."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Rules:
    """Significance levels, thresholds and limits of a diagnosis (docs/explanation/diagnosis.md).

    The share of an explanation is the fraction of the explainable misfit that it takes. Replicates are
    those of the bootstrap over specimens, tests or parts of records.

    Attributes
    ----------
    false_alarm_rate : probability of naming a cause if there is none.
    extra_cause_rate : probability of naming one cause too many.
    lack_of_fit_level : p-value of the residuals of a fit below which they count as unexplained.
    score_tolerance : explanations within this of the best score (chi-square) are equivalent.
    first_fraction : explanations that would rank first in this fraction of the replicates of the noise are
        equivalent too: a name is given alone if it would come first nine times in ten.
    max_confirmed : largest number of effects that are confirmed in the simulator.
    max_pairs : largest number of pairs of causes that are confirmed.
    max_causes : largest number of causes that are named together, if the model allows as many.
    max_triples : largest number of pairs to which a third cause is added, and of third causes confirmed for
        each.
    seed : seed of the bootstrap.
    replicates : number of replicates of the bootstrap.
    least_share : least share of causes that are named although more than noise is left. Of two equally large
        causes, one of them outside the library, each takes about one half.
    least_share_low : least share in `replicate_level` of the replicates.
    replicate_level : fraction of the replicates, and of the draws of held-out parts, in which a condition
        holds.
    least_skill : least held-out skill: fraction of the squared error beyond noise that the extension removes.
    least_share_within_test : least share in `replicate_level` of the replicates, if measurements can only
        be held out from within a test: errors common to one test, smooth unstated errors among them, are
        then in the training part too.
    further_share : least further share that one cause more must take.
    alternative_fraction, alternative_margin : another explanation is named too if it takes more in this
        fraction of the replicates, or if its share is within this of the first.
    amplitude_tolerance, amplitude_tolerance_sds : largest change of an amplitude from fold to fold, as a
        fraction of it, or in its standard deviations.
    max_held_out : largest number of explanations whose held-out skill is measured before none is named.
    smooth_error_fraction : size of a smooth unstated error, as a fraction of full scale: a smaller misfit
        of the baseline is not named if the noise is not known.
    negligible_fraction : fraction of full scale below which the remaining misfit is negligible in practice.
    """

    false_alarm_rate: float = 0.02
    extra_cause_rate: float = 0.003
    lack_of_fit_level: float = 0.005
    score_tolerance: float = 6.0
    first_fraction: float = 0.1
    max_confirmed: int = 7
    max_pairs: int = 5
    max_causes: int = 3
    max_triples: tuple[int, int] = (2, 3)
    seed: int = 0
    replicates: int = 400
    least_share: float = 0.4
    least_share_low: float = 0.1
    replicate_level: float = 0.95
    least_skill: float = 0.4
    least_share_within_test: float = 0.75
    further_share: float = 0.1
    alternative_fraction: float = 0.05
    alternative_margin: float = 0.02
    amplitude_tolerance: float = 0.5
    amplitude_tolerance_sds: float = 3.0
    max_held_out: int = 5
    smooth_error_fraction: float = 0.01
    negligible_fraction: float = 0.01
