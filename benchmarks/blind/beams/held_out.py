"""Held-out improvement by a named cause, compared with the noise and with a fit that is given the true cause.

The rms on held-out data contains the noise of these data, which no fit removes: `raw` is the relative
reduction of the rms itself, `beyond` that of its excess over the noise (root of the difference of squares).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.blind.beams.scores import Goal, Scored
from benchmarks.blind.under_test import Verdict

LARGE = 10.0  # sigmas
FALL, NEAR = 0.30, 1.2


@dataclass(frozen=True, kw_only=True)
class Fall:
    """Held-out rms [mm].

    Attributes ---------- before, after, noise : of the baseline, of the extension and of noise alone.
    true_cause : of the extension found with the true cause alone in the catalogue; None if this was not run
    or
        found none.
    """

    before: float
    after: float
    noise: float
    true_cause: float | None = None

    @property
    def raw(self) -> float:
        return 1 - self.after / self.before

    @property
    def beyond(self) -> float:
        """Relative reduction of the excess over the noise; 0 if the baseline has none."""
        excess = _excess(self.before, self.noise)
        return 1 - _excess(self.after, self.noise) / excess if excess else 0.0

    @property
    def has_room(self) -> bool:
        """True if the rms could fall by 30 % before it reaches the noise."""
        return self.noise <= (1 - FALL) * self.before

    @property
    def near(self) -> bool:
        assert self.true_cause is not None
        return self.after <= NEAR * self.true_cause

    @property
    def near_beyond(self) -> bool:
        """True if the excess over noise is at most 1.2 times that with the true cause.

        A thousandth of the noise counts as no excess.
        """
        assert self.true_cause is not None
        reachable = _excess(self.true_cause, self.noise)
        return _excess(self.after, self.noise) <= NEAR * reachable + 1e-3 * self.noise


def _excess(rms: float, noise: float) -> float:
    return float(np.sqrt(max(rms**2 - noise**2, 0.0)))


def measured(diagnosis: Verdict) -> bool:
    return bool(diagnosis.get("gain"))


def fall(diagnosis: Verdict, true_cause: Verdict | None) -> Fall | None:
    """Held-out rms of a diagnosis; None if it was not measured or no fold keeps the effect estimable."""
    gain = diagnosis.get("gain") or {}
    if gain.get("rms_mm_before") is None:
        return None
    known = ((true_cause or {}).get("gain") or {}).get("rms_mm_after")
    return Fall(
        before=gain["rms_mm_before"], after=gain["rms_mm_after"], noise=gain["rms_mm_noise"], true_cause=known
    )


def large(case: Scored) -> bool:
    return bool(case.truth["category"] == "single" and case.sigma >= LARGE)


def gain_goals(cases: Mapping[str, Scored], true_cause: Mapping[str, Verdict]) -> list[Goal]:
    """Goals of single effects of 10 sigmas and above.

    In a run that measures gains, cases in which nothing was named count as missed; cases without a usable
    fold do not count.
    """
    some = {key: c for key, c in cases.items() if large(c)}
    falls = {key: fall(c.diagnosis, true_cause.get(key)) for key, c in some.items()}
    there = [f for f in falls.values() if f is not None]
    running = any(measured(c.diagnosis) for c in cases.values())
    nothing = [key for key, c in some.items() if not c.named] if running else []
    # a fit that is given the cause shows what could have been reached where nothing was named
    reachable = sum(fall(true_cause[key], None) is not None for key in nothing if key in true_cause)
    compared = [f for f in there if f.true_cause is not None]
    no_fold = sum(measured(c.diagnosis) and falls[key] is None for key, c in some.items())
    count = len(there) + len(nothing)
    head = ">= 10 sigma, held out: "
    return [
        (head + "no fold keeps the effect estimable", "-", no_fold, len(some)),
        (head + "rms falls by 30 % (noise included)", "100 %", sum(f.raw >= FALL for f in there), count),
        (
            head + "the same, of those where noise leaves room",
            "100 %",
            sum(f.raw >= FALL for f in there if f.has_room),
            sum(f.has_room for f in there),
        ),
        (
            head + "excess over noise falls by 30 %",
            "100 %",
            sum(f.beyond >= FALL for f in there),
            count,
        ),
        (
            head + "rms within 1.2 of a fit given the cause",
            "100 %",
            sum(f.near for f in compared),
            len(compared) + reachable,
        ),
        (
            head + "excess over noise within 1.2 of it",
            "-",
            sum(f.near_beyond for f in compared),
            len(compared) + reachable,
        ),
    ]


def gain_table(cases: Mapping[str, Scored], true_cause: Mapping[str, Verdict]) -> str:
    """One line per case of 10 sigmas and above, and the medians."""
    lines = [
        f"{'held-out rms [mm]':42} {'before':>7} {'after':>7} {'noise':>7} {'given':>7}"
        f" {'fall':>6} {'beyond noise':>12}"
    ]
    falls = []
    for key, case in cases.items():
        if not large(case):
            continue
        f = fall(case.diagnosis, true_cause.get(key))
        head = f"{key} {case.effects[0]} [{case.sigma:.1f}]"
        if f is None:
            lines.append(f"{head:42} {_why(case)}")
            continue
        falls.append(f)
        reachable = f"{f.true_cause:7.4f}" if f.true_cause is not None else f"{'-':>7}"
        lines.append(
            f"{head:42} {f.before:7.4f} {f.after:7.4f} {f.noise:7.4f} {reachable}"
            f" {100 * f.raw:4.0f} % {100 * f.beyond:10.0f} %"
        )
    if falls:
        raw, beyond = _median([f.raw for f in falls]), _median([f.beyond for f in falls])
        lines.append(f"medians of {len(falls)}: rms falls by {raw} %, its excess over noise by {beyond} %")
    return "\n".join(lines)


def _why(case: Scored) -> str:
    if not case.named:
        return f"nothing named ({case.verdict})"
    return case.diagnosis["gain"]["note"] or "no fold" if measured(case.diagnosis) else "gain not measured"


def _median(values: Sequence[float]) -> str:
    return f"{100 * float(np.median(values)):.0f}"
