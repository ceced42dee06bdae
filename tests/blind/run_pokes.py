"""Made poke experiments, handed to the diagnosis without their truth: `python tests/blind/run_pokes.py`.

Prints each case, the confusion matrix and the goals. Cases are drawn from --seed; the truth never leaves this
process's memory.
"""

from __future__ import annotations

from _blind_poke_draw import draw_cases, make_poke
from _blind_poke_file import write
from _blind_poke_verdict import verdict_on
from _blind_record_case import draw_several
from _blind_record_run import diagnosed, parser, show
from _blind_record_score import Pair


def run(count: int, seed: int, *, only: slice = slice(None), tell: bool = True) -> list[Pair]:
    """(truth, verdict) of each case."""
    cases = list(enumerate(draw_cases(count, seed)))[only]
    return diagnosed(cases, write, verdict_on, tell=tell)


def main() -> None:
    options = parser(__doc__)
    options.add_argument("--first", type=int, default=0, help="case to begin with")
    options.add_argument("--last", type=int, default=None, help="case to end before")
    asked = options.parse_args()
    if asked.together:
        several = list(enumerate(draw_several(asked.cases, asked.seed, make_poke, asked.together)))
        show(diagnosed(several[asked.first : asked.last], write, verdict_on, tell=True), asked.out)
        return
    show(run(asked.cases, asked.seed, only=slice(asked.first, asked.last)), asked.out)


if __name__ == "__main__":
    main()
