"""What the simulator says of records: forces at their depths, with a state's effects nested in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.nested import State
from calibration.diagnosis.pokes._candidates import kind_of, reaches
from calibration.diagnosis.pokes._curve import Curve
from calibration.diagnosis.pokes._curves import Curves, Wanted
from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects import PokeEffect

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Simulation:
    """specimens: whose ln(G / 1 Pa) are a state's u, in this order. visible: which candidates the
    measurements can show; others are taken not to be there."""

    curves: Curves
    effects: Mapping[str, PokeEffect]
    specimens: Sequence[str]
    visible: Mapping[Candidate, bool]

    def shear(self, record: Record, state: State) -> float:
        """Of the record's specimen [Pa]."""
        return float(np.exp(state.u[self.specimens.index(record.specimen)]))

    def base(self, record: Record) -> Curve:
        """Without effects."""
        return base(self.curves, record)

    def along(self, state: State, record: Record) -> Array:
        """(k,) [N], with all effects."""
        acting = self._acting(state, record)
        depth = record.depth.copy()
        for (name, _), a in acting.items():
            shift = self.effects[name].shift
            if shift is not None:
                depth = depth + shift(a, record)
        unit = self.base(record).at(depth)
        for (name, kind), a in acting.items():
            if self.effects[name].scene is not None:
                unit = unit + self._changed(record, name, kind, a, depth, across=False)
        force = self.shear(record, state) * np.maximum(unit, 0.0)
        for (name, kind), a in sorted(acting.items(), key=lambda item: self.effects[item[0][0]].stage):
            apply = self.effects[name].force
            if apply is not None:
                force = apply(force, a, record, kind)
        return np.asarray(force)

    def across(self, state: State, record: Record) -> Array:
        """(k, 2) [N]: what is simulated only; faults of the load cell are those along the rod."""
        unit = self.base(record).sides(record.depth)
        for (name, kind), a in self._acting(state, record).items():
            if self.effects[name].scene is not None:
                unit = unit + self._changed(record, name, kind, a, record.depth, across=True)
        return self.shear(record, state) * unit

    def prepare(self, states: Sequence[State], records: Sequence[Record]) -> None:
        """Simulate all that these states need, together."""
        wanted = []
        for state in states:
            for r in records:
                for (name, kind), a in self._acting(state, r).items():
                    effect = self.effects[name]
                    if effect.scene is None:
                        continue
                    for node, part in _between(self._nodes(r, effect), a, straight=effect.straight):
                        if node != 0.0 and part != 0.0:
                            wanted.append(self._wanted(r, name, kind, node))
        if wanted:
            self.curves.fetch(wanted)

    def step(self, candidate: Candidate, state: State, records: Sequence[Record]) -> float:
        """Of a column's difference: for what is simulated, at none the way to the effect's chord, elsewhere
        one that stays between two simulated amplitudes."""
        effect = self.effects[candidate.effect]
        now = state.amplitudes.get(candidate, 0.0)
        if effect.scene is None:
            return effect.step if now + effect.step <= effect.bounds[1] else -effect.step
        if now == 0.0:
            nodes = self._nodes(next(r for r in records if reaches(candidate, r, effect)), effect)
            chord = kind_of(candidate) if effect.chords else effect.chord
            return chord if chord in nodes else min(nodes, key=lambda n: (n == 0.0, abs(n)))
        inside = [n for n in effect.nodes if n != 0.0 and np.sign(n) == np.sign(now)]
        further = max((abs(n) for n in inside), default=abs(now))
        step = effect.step * float(np.sign(now))
        return step if abs(now) + effect.step <= further else -step

    def _changed(
        self, record: Record, name: str, kind: float | None, a: float, depth: Array, *, across: bool
    ) -> Array:
        """What an effect of the scene adds, over the shear modulus, between its simulated amplitudes."""
        base = self.base(record)
        found = np.zeros((depth.size, 2) if across else depth.size)
        effect = self.effects[name]
        for node, part in _between(self._nodes(record, effect), a, straight=effect.straight):
            if node != 0.0 and part != 0.0:
                curve = self.curves.fetch([self._wanted(record, name, kind, node)])[0]
                if across:
                    change = curve.sides(depth) - base.sides(depth)
                else:
                    force = np.where(record.kind > 0, curve.at(depth), curve.back(depth, record.turn))
                    change = force - base.at(depth)
                found = found + part * change
        return found

    def _nodes(self, record: Record, effect: PokeEffect) -> tuple[float, ...]:
        scene = record.geometry.scene(1e-3)
        assert effect.scene is not None
        make, kinds = effect.scene, effect.kinds([record])
        return tuple(n for n in effect.nodes if n == 0.0 or effect.fits(make(scene, None, n, kinds[0])))

    def _wanted(self, record: Record, name: str, kind: float | None, node: float) -> Wanted:
        effect = self.effects[name]
        make = effect.scene
        assert make is not None
        back = effect.back and bool((record.kind < 0).any())
        return Wanted(
            geometry=record.geometry,
            depth=_deepest(record),
            name=f"{name} {kind} {node:.9g}{' back' if back else ''}",
            change=lambda poke, mesh: make(poke, mesh, node, kind),
            finer=effect.finer,
            back=back,
        )

    def _acting(self, state: State, record: Record) -> dict[tuple[str, float | None], float]:
        """Effects in a record by name and kind, with the sum of their amplitudes there."""
        total: dict[tuple[str, float | None], float] = {}
        for c, a in state.amplitudes.items():
            if self.visible[c] and reaches(c, record, self.effects[c.effect]):
                key = (c.effect, None if self.effects[c.effect].chords else kind_of(c))
                total[key] = total.get(key, 0.0) + a
        return total


def base(curves: Curves, record: Record) -> Curve:
    """Of a record's poke without effects."""
    return curves.fetch([Wanted(geometry=record.geometry, depth=_deepest(record))])[0]


def reached(curves: Curves, records: Sequence[Record]) -> tuple[list[Record], tuple[str, ...]]:
    """Simulate each geometry; points deeper than a simulation reached are left out: a sentence each.
    ValueError where hardly any are left."""
    curves.fetch([Wanted(geometry=r.geometry, depth=_deepest(r)) for r in records])
    said, shortened = [], []
    for r in records:
        curve = base(curves, r)
        deep = r.depth > curve.reached
        if deep.any():
            first = int(np.argmax(deep))  # what came after depends on what is not there
            if first < 5:
                raise ValueError(f"{r.name}: the simulated poke ends at {1e3 * curve.reached:.2g} mm")
            kept = np.arange(r.points) < first
            said.append(
                f"{r.name}: from {1e3 * curve.reached:.2f} mm on not used, the simulation ended there"
                f" ({curve.status})"
            )
            r = r.only(kept)
        shortened.append(r)
    return shortened, tuple(said)


def _deepest(record: Record) -> float:
    return max(float(record.depth.max()), 1e-4)


def _between(nodes: Sequence[float], a: float, *, straight: bool) -> list[tuple[float, float]]:
    """Nodes with their parts that make up an amplitude: by the two parabolas through its neighbours and the
    next node on either side, the nearer side counting more, or straight; straight on beyond the last."""
    ordered = sorted(nodes)
    if len(ordered) == 1:
        return [(ordered[0], 1.0)]
    k = min(max(int(np.searchsorted(ordered, a)), 1), len(ordered) - 1)
    low, high = ordered[k - 1], ordered[k]
    t = (a - low) / (high - low)
    parts = {low: 1.0 - t, high: t}
    if straight or not 0.0 < t < 1.0:
        return list(parts.items())
    # what a parabola adds to the line, for a node further on: zero at both neighbours
    sides = [(n, w) for n, w in ((k - 2, 1.0 - t), (k + 1, t)) if 0 <= n < len(ordered)]
    whole = sum(w for _, w in sides)
    for n, w in sides:
        node = ordered[n]
        bend = w / whole * (a - low) * (a - high) / ((node - low) * (node - high))
        parts[node] = bend
        line = (node - low) / (high - low)
        parts[low] -= bend * (1.0 - line)
        parts[high] -= bend * line
    return list(parts.items())
