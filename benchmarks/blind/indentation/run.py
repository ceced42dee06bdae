"""Diagnose synthetic indentation experiments and score them: `python -m benchmarks.blind.indentation.run`.

Prints each case, the confusion matrix and the goals. Cases are drawn from --seed; the truth stays in memory
until all cases are diagnosed.
"""

from __future__ import annotations

from benchmarks.blind.indentation.cases import draw_cases, make_poke, write
from benchmarks.blind.record_scores import Pair, diagnosed, parser, show
from benchmarks.blind.records import draw_several
from benchmarks.blind.under_test import diagnose_indentation


def run(count: int, seed: int, *, only: slice = slice(None), show_each: bool = True) -> list[Pair]:
    """(truth, verdict) of each case."""
    cases = list(enumerate(draw_cases(count, seed)))[only]
    return diagnosed(cases, write, diagnose_indentation, show_each=show_each)


def main() -> None:
    options = parser(__doc__)
    options.add_argument("--first", type=int, default=0, help="case to begin with")
    options.add_argument("--last", type=int, default=None, help="case to end before")
    asked = options.parse_args()
    if asked.together:
        several = list(enumerate(draw_several(asked.cases, asked.seed, make_poke, asked.together)))
        show(
            diagnosed(several[asked.first : asked.last], write, diagnose_indentation, show_each=True),
            asked.out,
        )
        return
    show(run(asked.cases, asked.seed, only=slice(asked.first, asked.last)), asked.out)


if __name__ == "__main__":
    main()
