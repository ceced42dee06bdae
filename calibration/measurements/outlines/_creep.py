"""Creep of photographed beams from solutions of elastic beams, by the correspondence principle.

A beam under a constant load from time 0 has at time t very nearly the shape of an elastic beam whose modulus
is the inverse of the creep compliance, G_eff(t) = G_inf / J(t) (exactly at small rotations: W. N. Findley,
J. S. Lai, K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials, 1976, chapter 5). For a law
that is determined by its two small-strain moduli, all photographs of a trial lie on one curve over ln G_eff,
and depend almost linearly on 1 / (K/G_eff): a few dozen elastic beams are sufficient for a whole fit.
`OutlineModel.update_nuisances` corrects the error at large rotations by a viscoelastic beam.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._baseline import Baseline
from calibration.measurements._state import State
from calibration.measurements.outlines._photographs import TracedPhotograph, coefficients
from calibration.measurements.outlines._scenes import Scenes
from calibration.measurements.outlines._solutions import simulated
from calibration.measurements.outlines.simulators import Simulator
from tisim import Material, material_from_moduli
from tisim.parts import Spectrum

Array = NDArray[np.float64]

MESH = 0.08  # step of ln G between beams of a curve; the error of cubics is 1e-6 of the deflection
BULK_RATIOS = (300.0, 100.0)  # K/G_eff of the two curves
_REACH = np.array([-1, 0, 1, 2])  # offsets of the four beams of the cubic interpolation


def compliance(spectrum: Spectrum, time: Array) -> Array:
    """Creep compliance at times (t,) [s], relative to the compliance of the law's modulus.

    The internal strains follow tau_i dv_i/dt = e - v_i, with e = (1 + sum g_i v_i) / G_0. These equations are
    linear, with a symmetric matrix in the variables sqrt(g_i tau_i) v_i.
    """
    there = spectrum.strengths > 0.0
    g, tau = np.asarray(spectrum.strengths)[there], np.asarray(spectrum.times)[there]
    last, first = spectrum.equilibrium, spectrum.equilibrium + float(g.sum())
    root = np.sqrt(g / tau)
    rates, modes = np.linalg.eigh(np.outer(root, root) / first - np.diag(1.0 / tau))
    begin = -np.sqrt(g * tau) / last
    weights = (root @ modes) * (modes.T @ begin) / first
    return np.asarray(1.0 / last + np.exp(np.multiply.outer(np.asarray(time, dtype=float), rates)) @ weights)


def settled_by_moduli(baseline: Baseline) -> bool:
    """True if the baseline is one viscoelastic law that is determined by its shear modulus and K/G."""
    parts = {c.name for p in baseline.law.parts for c in p.coordinates}
    own = {c.name for c in baseline.law.coordinates} - parts
    viscous = any(p.field == "viscosity" for p in baseline.law.parts)
    return baseline.whole and viscous and own == {"shear_modulus", "bulk_ratio"}


@dataclass(frozen=True, eq=False, kw_only=True)
class CreepCurves:
    """Curves of elastic beams of all trials, solved on demand.

    Attributes
    ----------
    scenes : scenes of the trials.
    photographs : all photographs.
    simulator : simulator of the beams.
    workers : number of processes; None for all cores.
    """

    scenes: Scenes
    photographs: Sequence[TracedPhotograph]
    simulator: Simulator
    workers: int | None
    # coefficients of a photograph by its first row, index in BULK_RATIOS and number of the modulus
    _known: dict[tuple[int, int, int], Array] = field(default_factory=dict, init=False, repr=False)
    _solved: set[tuple[int, int, int]] = field(default_factory=set, init=False, repr=False)

    def values(self, photographs: Sequence[TracedPhotograph], states: Sequence[State]) -> list[Array]:
        """As `SolutionCache.values`, for given photographs and states without effects."""
        places = [[self._place(p, s) for p in photographs] for s in states]
        self._solve(
            {
                (p.beam, j, int(np.floor(x)) + int(k))
                for row in places
                for p, (x, _) in zip(photographs, row, strict=True)
                for k in _REACH
                for j in range(len(BULK_RATIOS))
            },
        )
        return [
            np.concatenate([self._at(p, *place) for p, place in zip(photographs, row, strict=True)])
            for row in places
        ]

    def _place(self, photograph: TracedPhotograph, state: State) -> tuple[float, float]:
        """ln G_eff in units of MESH, and K/G_eff, for a photograph at a state."""
        baseline, trial = self.scenes.baseline, photograph.trial
        own = baseline.law_coordinates(trial.material, state.u)
        moduli = baseline.law.moduli(own)
        viscosity = baseline.law.material(own).viscosity
        assert viscosity is not None, "settled_by_moduli"
        shear = moduli.shear_modulus / float(compliance(viscosity.spectrum(), np.array(photograph.time)))
        return float(np.log(shear)) / MESH, moduli.bulk_modulus / shear

    def _solve(self, wanted: set[tuple[int, int, int]]) -> None:
        """Solve the missing beams (trial, index of K/G, number of the modulus), stiff ones first."""
        missing = sorted(wanted - self._solved, key=lambda key: (key[0], key[1], -key[2]))
        beams = [
            self.scenes.elastic(trial, self._material(j, n), self.simulator.fidelity)
            for trial, j, n in missing
        ]
        results = simulated(beams, self.simulator.run, self.workers)
        for (trial, j, n), result in zip(missing, results, strict=True):
            self._solved.add((trial, j, n))
            for p in (p for p in self.photographs if p.beam == trial):
                found = np.full(p.basis.shape[1], np.nan)
                if result is not None:
                    images = self.scenes.images(trial, State(u=np.zeros(0)), time=p.time)
                    found = coefficients(p, result, images)
                self._known[p.rows.start, j, n] = found

    def _material(self, j: int, n: int) -> Material:
        shear = float(np.exp(n * MESH))
        law = self.scenes.baseline.law.law
        return material_from_moduli(law, shear_modulus=shear, bulk_modulus=BULK_RATIOS[j] * shear)

    def _at(self, photograph: TracedPhotograph, x: float, bulk_ratio: float) -> Array:
        """Interpolated coefficients of a photograph [m], shape (m,), at a point of `_place`."""
        n = int(np.floor(x))
        cubic = _lagrange(x - n)
        both = [
            cubic @ np.array([self._known[photograph.rows.start, j, n + int(k)] for k in _REACH])
            for j in range(len(BULK_RATIOS))
        ]
        stiff, soft = (1.0 / r for r in BULK_RATIOS)
        part = (1.0 / bulk_ratio - stiff) / (soft - stiff)
        return np.asarray(both[0] + part * (both[1] - both[0]))


def _lagrange(x: float) -> Array:
    """Lagrange weights (4,) of the values at _REACH, for x in [0, 1]."""
    weights = [
        np.prod([(x - other) / (node - other) for other in _REACH if other != node]) for node in _REACH
    ]
    return np.array(weights, dtype=float)
