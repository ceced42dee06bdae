"""Search coordinates of a Prony series (`tisim.Prony`): fractions of the long-time modulus, relaxation times.

`prony:N` has N terms, whose times are free. `prony:spectrum` has two times a decade across what the tests can
see; its fractions, 0 or more, have a normal prior: neighbouring terms are too much alike for the data alone.
They are coordinates themselves, and not their logarithms, since most of a spectrum may be 0.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from calibration.parameters._coordinates import Coordinate, PartCoordinates, ProtocolWindow, Values
from calibration.parameters._parts import PartKind, register_part
from tisim import Prony, laws
from tisim.parts import Part

MOST = 3  # terms with free times: more cannot be told apart by a few decades of time
FRACTION, FRACTION_LOG_SD = 0.2, 2.0  # prior of a term's fraction
# of a term of a spectrum: a rubber relaxes by some 5 % a decade, soft tissue by up to ten times that
SPECTRUM, SPECTRUM_SD, SPECTRUM_MOST = 0.03, 0.3, 3.0
BELOW, ABOVE = 30.0, 10.0  # how far free times may leave the window, as factors
A_DECADE = 2  # times of a spectrum
ALIKE = 10.0  # ratio of relaxation times below which two terms are hard to tell apart


def prony(argument: str, window: ProtocolWindow) -> PartCoordinates:
    """prony:N or prony:spectrum."""
    if argument == "spectrum":
        return _spectrum(window)
    if argument not in [str(n) for n in range(1, MOST + 1)]:
        raise ValueError(f"expected {USAGE}")
    terms = int(argument)
    low, high = window.first / BELOW, window.last * ABOVE
    # one ramp alone shows a single time: starts are spread over what the times may be
    between = (window.first, window.last) if window.last > window.first else (low, high)
    starts = np.geomspace(*between, terms + 2)[1:-1]
    # ln of a time: 2 sd from the middle to either bound
    middle, sd = 0.5 * float(np.log(low * high)), 0.25 * float(np.log(high / low))
    coordinates = []
    for i, start in enumerate(starts):
        coordinates.append(
            _fraction(i, start=FRACTION / terms, prior=(float(np.log(FRACTION)), FRACTION_LOG_SD))
        )
        coordinates.append(
            Coordinate(
                name=f"prony_time_{i + 1}",
                unit="s",
                log=True,
                low=low,
                high=high,
                spread=0.5,
                start=float(start),
                prior=(middle, sd),
            )
        )

    def assemble(v: Values) -> Prony:
        times = tuple(v[f"prony_time_{i + 1}"] for i in range(terms))
        if any(b <= a for a, b in pairwise(times)):
            raise ValueError("times: expected relaxation times that rise from term to term")
        return Prony(fractions=_fractions(v, terms), times=times)

    def take_apart(part: Part) -> Values:
        if not isinstance(part, Prony) or len(part.times) != terms:
            raise ValueError(f"prony:{terms}: expected a Prony series of so many terms, got {part!r}")
        spectrum = part.spectrum()
        found = {}
        for i, k in enumerate(np.argsort(spectrum.times)):
            found[f"prony_fraction_{i + 1}"] = float(spectrum.strengths[k] / spectrum.equilibrium)
            found[f"prony_time_{i + 1}"] = float(spectrum.times[k])
        return found

    return _part(f"prony:{terms}", window, coordinates, assemble, take_apart)


def _spectrum(window: ProtocolWindow) -> PartCoordinates:
    decades = max(float(np.log10(window.last / window.first)), 0.5)
    count = round(A_DECADE * decades) + 1
    times = tuple(float(t) for t in window.first * 10.0 ** (np.arange(count) / A_DECADE))
    coordinates = [
        Coordinate(
            name=f"prony_fraction_{i + 1}",
            unit="-",
            log=False,
            low=0.0,
            high=SPECTRUM_MOST,
            spread=0.05,
            start=SPECTRUM,
            prior=(SPECTRUM, SPECTRUM_SD),
            limit_low="no relaxation",
        )
        for i in range(count)
    ]

    def assemble(v: Values) -> Prony:
        return Prony(fractions=_fractions(v, count), times=times)

    return _part("prony:spectrum", window, coordinates, assemble)


def _part(
    spec: str,
    window: ProtocolWindow,
    coordinates: list[Coordinate],
    assemble: Callable[[Values], Prony],
    take_apart: Callable[[Part], Values] | None = None,
) -> PartCoordinates:
    def describe(values: Values, moduli: laws.Moduli) -> list[str]:
        return _remarks(assemble(values), moduli, window, stated=spec == "prony:spectrum")

    return PartCoordinates(
        spec=spec,
        label=spec.replace(":", "-"),
        field="viscosity",
        window=window,
        coordinates=tuple(coordinates),
        assemble=assemble,
        describe=describe,
        take_apart=take_apart,
    )


def _fraction(i: int, *, start: float, prior: tuple[float, float]) -> Coordinate:
    return Coordinate(
        name=f"prony_fraction_{i + 1}",
        unit="-",
        log=True,
        low=1e-4,
        high=20.0,
        spread=0.4,
        start=start,
        prior=prior,
        limit_low="no relaxation",
    )


def _fractions(v: Values, terms: int) -> tuple[float, ...]:
    return tuple(v[f"prony_fraction_{i + 1}"] for i in range(terms))


def _remarks(found: Prony, moduli: laws.Moduli, window: ProtocolWindow, *, stated: bool) -> list[str]:
    at_once = found.spectrum().instantaneous
    said = [
        "moduli are long-time ones, and fractions parts of them: the instantaneous shear modulus is"
        f" {at_once * moduli.shear_modulus / 1e3:.4g} kPa ({at_once:.4g} times the long-time one)"
    ]
    if stated:
        listed = ", ".join(f"{t:.3g}" for t in found.times)
        said.append(f"the relaxation times {listed} s are stated, not fitted")
        return said
    seen = f"what the tests show ({window.first:.3g} s to {window.last:.3g} s)"
    for i, t in enumerate(found.times):
        if not window.first <= t <= window.last:
            said.append(f"relaxation time {i + 1}, {t:.3g} s, is outside {seen}")
    for i, (a, b) in enumerate(pairwise(found.times)):
        if b < ALIKE * a:
            said.append(
                f"relaxation times {i + 1} and {i + 2}, {a:.3g} and {b:.3g} s, are closer than a decade:"
                " their fractions are hard to tell apart, their sum is not"
            )
    return said


USAGE = ", ".join(["prony", *(f"prony:{n}" for n in range(1, MOST + 1)), "prony:spectrum"])

register_part(
    PartKind(
        name="prony",
        option="time",
        usage=USAGE,
        make=prony,
        needs_time=True,
        alternatives=tuple(str(n) for n in range(1, MOST + 1)),
    )
)
