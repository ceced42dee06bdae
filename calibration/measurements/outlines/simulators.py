"""Simulators whose errors can be diagnosed: the default one, and three with a known deficiency each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from calibration.measurements.outlines.fidelity import COARSE, REFERENCE, Fidelity
from tisim import Beam, Result, Solver, Status, paper_stop, simulate

# Beams for the correction of the search's mesh error, which for a bench of nine beams is 12 in chi. Their
# remaining error depends on the number of radial elements (2, 3 and 4 give 10.3, 12.0 and 12.5; shorter ones
# change almost nothing) and decreases with its square: it is extrapolated from two numbers. Next to a clamp
# beams remain too stiff, by 0.09 mm of grip on average over four clean cases of another solver (0.12 without
# the extrapolation).
CORRECTING = (
    Fidelity(axial_element_size=0.005, radial_elements=2, solver=REFERENCE.solver),
    Fidelity(axial_element_size=0.005, radial_elements=3, solver=REFERENCE.solver),
)


class Run(Protocol):
    def __call__(self, scenes: Sequence[Beam], *, workers: int | None) -> list[Result]: ...


@dataclass(frozen=True, kw_only=True)
class Simulator:
    """A simulator of beams.

    Attributes
    ----------
    name : name on the command line and in reports.
    sentence : description for reports.
    fidelity : discretisation of the beams of a search.
    reference : discretisations for the correction of the mesh error, with fewer and with more radial
        elements; None for no correction.
    run : function with the signature of `tisim.simulate`.
    surrogate : discretisation of static beams whose derivatives guide a search, if its own beams are
        expensive and not smooth; None for its own.
    """

    name: str
    sentence: str
    fidelity: Fidelity
    reference: tuple[Fidelity, Fidelity] | None = None
    run: Run = simulate
    surrogate: Fidelity | None = None

    @property
    def as_surrogate(self) -> Simulator:
        """Simulator whose derivatives guide a search."""
        return (
            self
            if self.surrogate is None
            else replace(self, fidelity=self.surrogate, run=simulate, surrogate=None)
        )


def _stopped(scenes: Sequence[Beam], *, workers: int | None) -> list[Result]:
    """Dynamic simulation of beams released from the straight shape, stopped by the paper's rule.

    The duration is not known in advance; that of the first beam of each length and support is used as a guess
    for the others.
    """
    found: list[Result] = [
        replace(r, status=Status.UNFINISHED) for r in simulate([_static(b) for b in scenes], workers=workers)
    ]
    alike: dict[object, list[int]] = {}
    for k, b in enumerate(scenes):
        alike.setdefault((b.supports, b.length), []).append(k)
    firsts = [group[0] for group in alike.values()]
    lasted = _released(scenes, dict.fromkeys(firsts, _SHORTEST), found, workers)
    others = {k: _longer(lasted[group[0]], _MARGIN) for group in alike.values() for k in group[1:]}
    _released(scenes, others, found, workers)
    return found


def _released(
    scenes: Sequence[Beam], durations: dict[int, float], found: list[Result], workers: int | None
) -> dict[int, float]:
    """Simulate beams until the rule stops them, and store their results in `found`.

    A run that is not stopped within its duration is repeated with twice the duration, up to _LONGEST.

    Returns
    -------
    dict of int to float
        Time at which the rule stopped each beam [s]; _LONGEST if it did not.
    """
    lasted = dict.fromkeys(durations, _LONGEST)
    waiting = dict(durations)
    while waiting:
        some = [replace(scenes[k], solver=replace(scenes[k].solver, duration=t)) for k, t in waiting.items()]
        runs = dict(zip(waiting, simulate(some, workers=workers), strict=True))
        longer = {}
        for k, run in runs.items():
            stop = paper_stop(run, run.mesh.nodes) if len(run.load) else None
            if stop is not None:
                at = int(np.argmin(np.abs(run.load - stop.time)))
                found[k] = replace(run, status=Status.CONVERGED, positions=run.positions[at][None])
                lasted[k] = stop.time
            elif waiting[k] < _LONGEST:
                longer[k] = _longer(waiting[k], 2.0)
        waiting = longer
    return lasted


def _longer(duration: float, times: float) -> float:
    """Product of duration and factor, rounded up to whole windows of the rule, at most _LONGEST [s]."""
    return min(_LONGEST, _WINDOW * float(np.ceil(duration * times / _WINDOW)))


def _static(beam: Beam) -> Beam:
    return replace(beam, solver=COARSE.solver)


_WINDOW = 0.05  # window of the rule [s], which needs three
_SHORTEST, _LONGEST = 4 * _WINDOW, 4.0  # shortest and longest duration of a run [s]
_MARGIN = 1.2
_DYNAMIC = Solver(method="implicit", tolerance=1e-4, time_step=5e-3, mass_damping=0.1, stiffness_damping=0.01)

TISIM = Simulator(
    name="tisim",
    sentence="mixed quadratic tetrahedra in equilibrium",
    fidelity=COARSE,
    reference=CORRECTING,
)

SIMULATORS = {
    s.name: s
    for s in (
        TISIM,
        Simulator(
            name="linear-tetrahedra",
            sentence="plain 4-node tetrahedra in equilibrium, as the paper's elements",
            fidelity=Fidelity(
                element="tet4", axial_element_size=0.0035, radial_elements=3, solver=COARSE.solver
            ),
        ),
        Simulator(
            name="early-stop",
            sentence="released beams, stopped by the paper's rule",
            fidelity=Fidelity(radial_elements=1, solver=_DYNAMIC),
            run=_stopped,
            surrogate=Fidelity(radial_elements=1, solver=COARSE.solver),
        ),
        Simulator(
            name="coarse-mesh",
            sentence="mixed quadratic tetrahedra on a mesh twice too coarse",
            fidelity=Fidelity(axial_element_size=0.02, radial_elements=1, solver=COARSE.solver),
        ),
    )
}
