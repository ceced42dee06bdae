"""How often a fit's 95 % intervals hold the truth: made experiments, fitted by the command under test.

    python -m benchmarks.blind.timed.recover coupons --seeds 20 --out DIR
    python -m benchmarks.blind.timed.recover coupons --parts fibres --seeds 20 --out DIR
    python -m benchmarks.blind.timed.recover beams --seeds 20 --out DIR
    python -m benchmarks.blind.timed.recover indentation --seeds 20 --out DIR
    python -m benchmarks.blind.timed.recover together --seeds 20 --out DIR

Each seed's experiment is made in DIR/KIND-SEED, unless it is there, its truth is put beside it
(DIR/KIND-SEED.truth.yaml: the fit's folder holds none), and `python -m calibration.fit DIR/KIND-SEED --model
LAW --time prony ...` is run into DIR/KIND-SEED.fit. Its estimates are read from
DIR/KIND-SEED.fit/fits/M-LAW+PARTS.json ("M-ogden+prony+mullins.json"): those with the names of NAMES. With
`--in-process` the command is called in this process, which keeps what it has compiled and simulated. A fit
that fails counts as a miss of all its parameters, and its message is printed. `--score` runs no fit and
scores the folders that are there. Results: DIR/KIND.json. Exit code 1 where a fit failed or fewer than --goal
of the intervals hold.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import yaml

from benchmarks.blind.timed.cases import KINDS, MATERIAL, PARTS, write
from benchmarks.blind.timed.make import drawn
from benchmarks.blind.under_test import NotFittedError, estimates_of, fit_command, fit_in_process
from benchmarks.whole import write_whole

GOAL = 0.9
OPTIONS = {"prony": ("--time", "prony"), "mullins": ("--damage", "mullins"), "fibres": ("--fibres",)}
# parameter of truth.yaml: names that an estimate of it may have. SI; the shear modulus is the long-time
# one, and fractions are parts of it
NAMES = {
    "shear_modulus": ("shear_modulus", "G"),
    "alpha": ("alpha",),
    "prony.fraction.1": ("prony_fraction_1", "g1"),
    "prony.fraction.2": ("prony_fraction_2", "g2"),
    "prony.time.1": ("prony_time_1", "tau1"),
    "prony.time.2": ("prony_time_2", "tau2"),
    "mullins.r": ("mullins_r", "r"),
    "mullins.m": ("mullins_m", "m"),
    "fibres.k1": ("fibres_k1", "k1"),
    "fibres.k2": ("fibres_k2", "k2"),
    "fibres.angle": ("fibres_angle_deg", "angle_deg"),
}


@dataclass(frozen=True, kw_only=True)
class Interval:
    """A parameter of one seed: its truth and the fit's 95 % interval, SI (the angle in degrees).

    problem: why there is no interval.
    """

    seed: int
    parameter: str
    truth: float
    value: float | None = None
    low: float | None = None
    high: float | None = None
    problem: str = ""

    @property
    def holds(self) -> bool:
        """True if the interval contains the truth."""
        return self.low is not None and self.high is not None and self.low <= self.truth <= self.high


def parameters_of(material: dict[str, Any]) -> dict[str, float]:
    """Parameters of a material of truth.yaml that a fit should find, by the names of NAMES."""
    found = {"shear_modulus": float(material["shear_modulus_Pa"])}
    if material["alpha"] != [2.0]:
        found["alpha"] = float(material["alpha"][0])
    if "prony" in material:
        terms = zip(material["prony"]["fractions"], material["prony"]["times_s"], strict=True)
        for k, (fraction, time) in enumerate(sorted(terms, key=lambda term: term[1]), start=1):
            found[f"prony.fraction.{k}"], found[f"prony.time.{k}"] = float(fraction), float(time)
    if "mullins" in material:
        found["mullins.r"], found["mullins.m"] = material["mullins"]["r"], material["mullins"]["m_J_m3"]
    if "fibres" in material:
        f = material["fibres"]
        found["fibres.k1"], found["fibres.k2"], found["fibres.angle"] = f["k1_Pa"], f["k2"], f["angle_deg"]
    return found


def scored(seed: int, material: dict[str, Any], estimates: dict[str, dict[str, float]]) -> list[Interval]:
    """One interval a parameter of the truth; estimates: by name, each with value, low and high."""
    found = []
    for parameter, truth in parameters_of(material).items():
        named = [name for name in NAMES[parameter] if name in estimates]
        if not named:
            problem = f"the fit has no estimate named {' or '.join(NAMES[parameter])}"
            found.append(Interval(seed=seed, parameter=parameter, truth=truth, problem=problem))
            continue
        e = estimates[named[0]]
        found.append(
            Interval(
                seed=seed, parameter=parameter, truth=truth, value=e["value"], low=e["low"], high=e["high"]
            )
        )
    return found


def recover(
    kind: str,
    seed: int,
    out: Path,
    parts: Sequence[str] | None,
    *,
    score_only: bool = False,
    in_process: bool = False,
) -> list[Interval]:
    """Make, fit and score one seed."""
    folder = out / f"{kind}-{seed}"
    truth_path = out / f"{kind}-{seed}.truth.yaml"
    if not truth_path.exists():
        write(drawn(kind, seed, parts), folder)
        (folder / "truth.yaml").rename(truth_path)
    material = yaml.safe_load(truth_path.read_text(encoding="utf-8"))["materials"][MATERIAL]
    law = "ogden" if material["alpha"] != [2.0] else "neo-hookean"
    parts_of_it = [part for part in PARTS if part in material]
    options = [*(word for part in parts_of_it for word in OPTIONS[part]), "--no-held-out"]  # for its time
    fitted = out / f"{kind}-{seed}.fit"
    try:
        if not score_only:
            run = fit_in_process if in_process else fit_command
            run(folder, fitted, law, options)
        estimates = estimates_of(fitted, MATERIAL, "+".join([law, *parts_of_it]))
    except NotFittedError as error:
        print(f"{kind} {seed}: {error}", flush=True)
        truths = parameters_of(material).items()
        return [Interval(seed=seed, parameter=p, truth=t, problem=str(error)) for p, t in truths]
    return scored(seed, material, estimates)


def summary(intervals: Sequence[Interval]) -> list[str]:
    """A line a parameter, and one of all."""
    lines = []
    for parameter in dict.fromkeys(i.parameter for i in intervals):
        mine = [i for i in intervals if i.parameter == parameter]
        held = sum(i.holds for i in mine)
        off = sorted(abs(i.value / i.truth - 1.0) for i in mine if i.value is not None)
        text = f"{parameter:18} {held:3d} of {len(mine):3d} intervals hold the truth"
        if off:
            text += f"; median error {off[len(off) // 2]:.1%}"
        if len(off) < len(mine):
            text += f"; {len(mine) - len(off)} without an interval"
        lines.append(text)
    held = sum(i.holds for i in intervals)
    lines.append(
        f"{'all':18} {held:3d} of {len(intervals):3d}: {held / len(intervals):.0%} (goal {GOAL:.0%})"
    )
    return lines


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("kind", choices=list(KINDS))
    parser.add_argument("--seeds", type=int, default=20, help="how many, from --first on")
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--parts", nargs="*", choices=PARTS, help="of coupons: default prony mullins")
    parser.add_argument("--score", action="store_true", help="run no fit, score those that are there")
    parser.add_argument("--in-process", action="store_true", help="fits in this process, one core")
    parser.add_argument("--goal", type=float, default=GOAL)
    given = parser.parse_args(argv)
    if given.parts is not None and given.kind != "coupons":
        parser.error("--parts: expected with coupons only")
    if given.seeds < 1:
        parser.error("--seeds: expected one or more")
    given.out.mkdir(parents=True, exist_ok=True)
    intervals: list[Interval] = []
    for seed in range(given.first, given.first + given.seeds):
        intervals += recover(
            given.kind,
            seed,
            given.out,
            given.parts,
            score_only=given.score,
            in_process=given.in_process,
        )
        text = json.dumps([asdict(i) | {"holds": i.holds} for i in intervals], indent=1)
        write_whole(given.out / f"{given.kind}.json", text + "\n")
    print("\n".join(summary(intervals)))
    held = sum(i.holds for i in intervals) / len(intervals)
    return int(held < given.goal or any(i.problem for i in intervals))


if __name__ == "__main__":
    sys.exit(main())
