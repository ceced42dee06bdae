"""Simulated forces of records at their depths, with effects.

An effect of the scene is simulated at a few amplitudes, its nodes, and interpolated between them. Without an
effect of history the force in unloading equals that in loading at the same depth, if there is no sliding
under the indenter (for a friction of 0.6: within 0.01 % in an independent simulation with unloading).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.measurements.indentation._curve import Curve
from calibration.measurements.indentation._curve_cache import CurveCache, CurveRequest
from calibration.measurements.indentation._effect import IndentationEffect
from calibration.measurements.indentation._memory_force import loads, stiffnesses, thresholds
from calibration.measurements.indentation._record import Record
from tisim.parts import Spectrum

Array = NDArray[np.float64]
# Amplitudes of the effects in a record [SI], by name, position (None here) and variant.
Acting = Mapping[tuple[str, float | None, float | None], float]

LEAST = 5  # least number of points of a record within the simulated depth


@dataclass(frozen=True, eq=False, kw_only=True)
class ForwardMap:
    """Forces of records.

    Attributes
    ----------
    curves : cache of curves, shared by all records.
    effects : effects by name.
    """

    curves: CurveCache
    effects: Mapping[str, IndentationEffect]

    def base(self, record: Record) -> Curve:
        """Curve of a record without effects."""
        return self.curves.fetch([CurveRequest(geometry=record.geometry, depth=record.deepest)])[0]

    def along(
        self,
        record: Record,
        curve: Curve,
        shear_modulus: float,
        acting: Acting,
        spectrum: Spectrum | None = None,
    ) -> Array:
        """Force along the indenter [N], shape (k,).

        Parameters
        ----------
        record : the record.
        curve : curve of the record's material without effects.
        shear_modulus : shear modulus [Pa]; with a spectrum, the one to which its fractions refer.
        acting : effects in the record.
        spectrum : relaxation spectrum of the material; None if it is elastic.
        """
        shift = np.zeros(record.points)
        for (name, _, _), a in acting.items():
            move = self.effects[name].shift
            if move is not None:
                shift = shift + move(a, record)
        unit = self._unit(record, curve.at, acting, spectrum, shift, across=False)
        force = shear_modulus * np.maximum(unit, 0.0)
        for (name, _, variant), a in sorted(acting.items(), key=lambda item: self.effects[item[0][0]].stage):
            apply = self.effects[name].force
            if apply is not None:
                force = apply(force, a, record, variant)
        return np.asarray(force)

    def across(
        self,
        record: Record,
        curve: Curve,
        shear_modulus: float,
        acting: Acting,
        spectrum: Spectrum | None = None,
    ) -> Array:
        """Force across the indenter [N], shape (k, 2), with effects of the scene only.

        Effects of the load cell and of the depth are modelled along the indenter. Parameters as in `along`.
        """
        still = np.zeros(record.points)
        return shear_modulus * self._unit(record, curve.sides, acting, spectrum, still, across=True)

    def _unit(
        self,
        record: Record,
        base: Callable[[Array], Array],
        acting: Acting,
        spectrum: Spectrum | None,
        shift: Array,
        *,
        across: bool,
    ) -> Array:
        """Force for a unit shear modulus, with effects of the scene, at depths that are wrong by `shift` [m].

        base : force without effects as a function of the depth, along or across the indenter.
        """

        def elastic(depth: Array, loading: NDArray[np.bool_]) -> Array:
            unit = base(depth)
            for (name, _, variant), a in acting.items():
                if self.effects[name].scene is not None:
                    change = self._change(record, name, variant, a, depth, loading=loading, across=across)
                    unit = unit + change
            return unit

        if spectrum is None:
            return elastic(record.depth + shift, record.direction > 0)
        return remembered(record, spectrum, elastic, shift)

    def prepare(self, needed: Sequence[tuple[Record, Acting]]) -> None:
        """Simulate, in one batch, the curves that these records need for these effects."""
        requests = []
        for record, acting in needed:
            for (name, _, variant), a in acting.items():
                effect = self.effects[name]
                if effect.scene is None:
                    continue
                for node, weight in node_weights(nodes_of(record, effect), a, straight=effect.straight):
                    if node != 0.0 and weight != 0.0:
                        requests.append(self._request(record, name, variant, node))
        if requests:
            self.curves.fetch(requests)

    def _change(
        self,
        record: Record,
        name: str,
        variant: float | None,
        a: float,
        depth: Array,
        *,
        loading: NDArray[np.bool_],
        across: bool,
    ) -> Array:
        """Change of the force over the shear modulus by an effect of the scene [m2], shape (k,) or (k, 2).

        depth : [m], shape (k,). loading : True for points in loading, shape (k,).
        """
        base = self.base(record)
        found = np.zeros((depth.size, 2) if across else depth.size)
        effect = self.effects[name]
        for node, weight in node_weights(nodes_of(record, effect), a, straight=effect.straight):
            if node != 0.0 and weight != 0.0:
                curve = self.curves.fetch([self._request(record, name, variant, node)])[0]
                if across:
                    change = curve.sides(depth) - base.sides(depth)
                else:
                    force = curve.at(depth)
                    if not loading.all():
                        force = np.where(loading, force, curve.retracting(depth, record.cycle_peak))
                    change = force - base.at(depth)
                found = found + weight * change
        return found

    def _request(self, record: Record, name: str, variant: float | None, node: float) -> CurveRequest:
        effect = self.effects[name]
        make = effect.scene
        assert make is not None
        retracts = effect.retracts and record.unloads
        return CurveRequest(
            geometry=record.geometry,
            depth=record.deepest,
            name=f"{name} {variant} {node:.9g}{' retracted' if retracts else ''}",
            change=lambda poke, mesh: make(poke, mesh, node, variant),
            finer=effect.finer,
            retracts=retracts,
        )


def remembered(
    record: Record,
    spectrum: Spectrum,
    elastic: Callable[[Array, NDArray[np.bool_]], Array],
    shift: Array,
) -> Array:
    """Force over the shear modulus of a viscoelastic material along a record's course [m2], (k,) or (k, 2).

    Parameters
    ----------
    record : record with a course.
    spectrum : relaxation spectrum.
    elastic : function of depths (m,) and a mask of loading to the elastic force over the modulus.
    shift : shift of the depths of the record's points [m], shape (k,).

    Raises
    ------
    ValueError
        If the record has no course.
    """
    if record.course is None:
        raise ValueError(f"record {record.name}: expected its course, for a material that remembers")
    depth = record.course.moved(shift)
    met = thresholds(max(float(depth.max()), 1e-6))
    springs = stiffnesses(met, elastic(met, np.ones(met.size, dtype=bool)))
    found = loads(spectrum, record.course.time, depth, met[:-1]) @ springs
    return np.asarray(found[record.course.at])


def at_depths(record: Record, shear_modulus: float, elastic: Callable[[Array], Array]) -> Array:
    """Elastic forces [N] at a record's depths; elastic : function from depths to force over the modulus."""
    return shear_modulus * elastic(record.depth)


def along_course(
    record: Record,
    shear_modulus: float,
    spectrum: Spectrum,
    elastic: Callable[[Array], Array],
    *,
    shift: float = 0.0,
) -> Array:
    """Viscoelastic forces [N] at a record's points, with all depths shifted by `shift` [m]."""
    moved = np.full(record.points, shift)
    return shear_modulus * remembered(record, spectrum, lambda depth, _: elastic(depth), moved)


def reached(curves: CurveCache, records: Sequence[Record]) -> tuple[list[Record], tuple[str, ...]]:
    """Simulate each geometry; cut each record before its first point beyond the simulated depth.

    Returns
    -------
    records : list of Record
    sentences : tuple of str
        One for each record that was cut.

    Raises
    ------
    ValueError
        If fewer than LEAST points of a record remain.
    """
    requests = [CurveRequest(geometry=r.geometry, depth=r.deepest) for r in records]
    sentences, shortened = [], []
    for r, curve in zip(records, curves.fetch(requests), strict=True):
        deep = r.depth > curve.reached
        if deep.any():
            first = int(np.argmax(deep))  # later points depend on those that are left out
            if first < LEAST:
                raise ValueError(f"{r.name}: the simulated indentation ends at {1e3 * curve.reached:.2g} mm")
            sentences.append(
                f"{r.name}: from {1e3 * curve.reached:.2f} mm on not used, the simulation ended there"
                f" ({curve.status})"
            )
            r = r.only(np.arange(r.points) < first)
        shortened.append(r)
    return shortened, tuple(sentences)


def difference_step(effect: IndentationEffect, chord: float | None, now: float, record: Record) -> float:
    """Finite-difference step of an effect of the scene.

    Parameters
    ----------
    effect : the effect.
    chord : node to which the difference at amplitude 0 goes; if the record lacks it, the smallest node.
    now : amplitude. If it is not zero the step is `effect.step` away from zero, or towards zero at the last
        node.
    record : record that defines the nodes.
    """
    if now == 0.0:
        nodes = nodes_of(record, effect)
        return chord if chord in nodes else min(nodes, key=lambda n: (n == 0.0, abs(n)))
    inside = [n for n in effect.nodes if n != 0.0 and np.sign(n) == np.sign(now)]
    further = max((abs(n) for n in inside), default=abs(now))
    step = effect.step * float(np.sign(now))
    return step if abs(now) + effect.step <= further else -step


def nodes_of(record: Record, effect: IndentationEffect) -> tuple[float, ...]:
    """Amplitudes at which a record's scene can be simulated with an effect, including 0."""
    scene = record.geometry.scene(1e-3)
    assert effect.scene is not None
    make, variants = effect.scene, effect.variants([record])
    return tuple(n for n in effect.nodes if n == 0.0 or effect.fits(make(scene, None, n, variants[0])))


def node_weights(nodes: Sequence[float], a: float, *, straight: bool) -> list[tuple[float, float]]:
    """Nodes and weights of the interpolation at an amplitude.

    The interpolant blends two parabolas, each through both neighbours and the next node on one side; the
    nearer side has the larger weight. It is linear if `straight`, and beyond the last node.
    """
    ordered = sorted(nodes)
    if len(ordered) == 1:
        return [(ordered[0], 1.0)]
    k = min(max(int(np.searchsorted(ordered, a)), 1), len(ordered) - 1)
    low, high = ordered[k - 1], ordered[k]
    t = (a - low) / (high - low)
    weights = {low: 1.0 - t, high: t}
    if straight or not 0.0 < t < 1.0:
        return list(weights.items())
    # difference of a parabola and the line, in terms of the further node: zero at both neighbours
    sides = [(n, w) for n, w in ((k - 2, 1.0 - t), (k + 1, t)) if 0 <= n < len(ordered)]
    whole = sum(w for _, w in sides)
    for n, w in sides:
        node = ordered[n]
        bend = w / whole * (a - low) * (a - high) / ((node - low) * (node - high))
        weights[node] = bend
        line = (node - low) / (high - low)
        weights[low] -= bend * (1.0 - line)
        weights[high] -= bend * line
    return list(weights.items())
