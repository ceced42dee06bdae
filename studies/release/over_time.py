"""The clamped Dragon Skin bar over time: one card (modulus, relaxation spectrum, density as stated) fitted to
all four runs; prints the tables of over_time.md.

    python -m studies.release.over_time               (some 20 core-seconds: the least squares)
    python -m studies.release.over_time --height 0    (as the file has it)
    python -m studies.release.over_time --cards DIR   (a core-minute: error bars, and the card)

The measurements are real/clamped-beam-dragonskin10/experiment of the folder that TISIM_MEASURED names. What
that file leaves out and its source says: the 52 g hang on the top edge of the free face, 15 mm over the axis.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from calibration.errors import InputError
from calibration.experiment import BeamTrial, Experiment, read
from calibration.measurements._state import State
from calibration.measurements.objective import ModelObjective
from calibration.measurements.release import HELD, RingDown, ringdown
from calibration.measurements.release.model import ReleaseModel
from calibration.parameters import parametrisation
from calibration.study import Measurements, calibrate, measurements, parts, write_card
from studies.measured import real

Array = NDArray[np.float64]

MATERIAL, SPECTRUM = "dragonskin10", "prony:spectrum"
EDGE = 0.015  # height of the load on the end face [m]
RINGING, SETTLED = 1.5, 1.6  # since the release [s]: the swing's end, and the beginning of what is settled
SWINGS = 2.2  # periods of a window in which frequency and damping are taken for themselves


@dataclass(frozen=True, kw_only=True)
class Tip:
    """Mean height of the tip's markers over time since the release.

    Attributes
    ----------
    drop : mean after SETTLED [mm].
    sinking : from SETTLED + 0.4 s to the end of the record, means over 0.3 s [mm].
    """

    drop: float
    ring: RingDown
    sinking: float

    @classmethod
    def of(cls, since: Array, height: Array) -> Tip:
        """height [m]."""
        after = since > 0.0
        z = -1e3 * height
        late = since[-1] - 0.3
        early = np.abs(since - SETTLED - 0.4) < 0.15
        return cls(
            drop=float(z[since > SETTLED].mean()),
            ring=ringdown(since[after], z[after], last=RINGING),
            sinking=float(z[since > late].mean() - z[early].mean()),
        )


@dataclass(frozen=True, kw_only=True)
class Compared:
    """A run beside the card. held : by how much its bar was held below straight [mm]."""

    name: str
    measured: Tip
    predicted: Tip
    held: float


def experiment_of(folder: Path, *, height: float = EDGE) -> Experiment:
    """The bar's experiment, with the height at which its loads hang [m]."""
    experiment = read(folder)
    trials = tuple(
        replace(t, tip_force_height=height) if isinstance(t, BeamTrial) and any(t.tip_force) else t
        for t in experiment.trials
    )
    return replace(experiment, trials=trials)


def measured(experiment: Experiment) -> tuple[Measurements, ModelObjective[ReleaseModel]]:
    """Measurements and objective of a fit over time to the runs."""
    law = parts.with_parts(parametrisation("neo-hookean"), (SPECTRUM,), experiment, MATERIAL)
    data = measurements(experiment, MATERIAL, law, workers=1)
    (objective,) = data.objectives
    assert isinstance(objective, ModelObjective)
    return data, objective


def least_squares_of(objective: ModelObjective[ReleaseModel]) -> State:
    """Start state of a fit of the runs, which is its least-squares solution already."""
    u = objective.suggested_start()
    assert u is not None, "a release says where a fit begins"
    return objective.state(u)


def compared(model: ReleaseModel, state: State) -> list[Compared]:
    """Each run beside the card. Its swing is that of a bar let go at once and damped by the material alone;
    on its way to rest it has the drag of its hung mass too, without which it would swing for longer."""
    values = model.nuisance_values(state)
    found = []
    for k, record in enumerate(model.records):
        tips = [m for m in record.trial.markers if m.position[0] > 0.5 * record.trial.free_length]
        time, height = tips[0].time, np.mean([m.displacement[:, 2] for m in tips], axis=0)
        since = time - record.release_time
        alone, dragged = (
            Tip.of(since, model.tip_height(k, _let_go(model, state, drag=drag), since))
            for drag in (False, True)
        )
        found.append(
            Compared(
                name=record.name,
                measured=Tip.of(since, height),
                predicted=replace(dragged, ring=alone.ring),
                held=1e3 * HELD * values[f"{record.name}: held below straight"],
            )
        )
    return found


def _let_go(model: ReleaseModel, state: State, *, drag: bool) -> State:
    """The state with all bars let go at once, from straight, at the first guess of the release."""
    own = (" start", " release") if drag else (" start", " release", " drag")
    u = np.where([name.endswith(own) for name in model.names], 0.0, state.u)
    return replace(state, u=u)


def swings(experiment: Experiment) -> list[tuple[str, list[tuple[float, float, float]]]]:
    """Free vibration of the tip in each run, by windows of SWINGS periods, without a model of the beam.

    Amplitude [mm], frequency [Hz] and damping ratio of a decaying oscillation about a straight line.
    """
    found = []
    for trial in experiment.trials:
        assert isinstance(trial, BeamTrial)
        tips = [m for m in trial.markers if m.position[0] > 0.5 * trial.free_length]
        time, z = tips[0].time, 1e3 * np.mean([m.displacement[:, 2] for m in tips], axis=0)
        begin = float(time[np.flatnonzero(np.abs(z - z[0]) > 0.5)[0]])
        rate = ringdown(time - begin, z, last=RINGING).frequency
        length, rows = SWINGS / rate, []
        for k in range(5):
            inside = (time > begin + k * length + 0.05) & (time < begin + (k + 1) * length + 0.05)
            rows.append(_swing(time[inside] - time[inside][0], z[inside], rate))
        found.append((trial.id, rows))
    return found


def _swing(t: Array, y: Array, rate: float) -> tuple[float, float, float]:
    def basis(p: Array) -> Array:
        envelope = np.exp(-p[0] * t)
        return np.column_stack([np.ones_like(t), t, envelope * np.cos(p[1] * t), envelope * np.sin(p[1] * t)])

    def left(p: Array) -> Array:
        B = basis(p)
        return np.asarray(y - B @ np.linalg.lstsq(B, y, rcond=None)[0])

    starts = [[c, 2.0 * np.pi * rate * f] for c in (1.0, 3.0) for f in (0.95, 1.0, 1.1)]
    best = min((least_squares(left, s) for s in starts), key=lambda found: found.cost)
    c, w = (float(v) for v in best.x)
    amount = np.linalg.lstsq(basis(best.x), y, rcond=None)[0]
    return float(np.hypot(amount[2], amount[3])), w / (2.0 * np.pi), c / float(np.hypot(c, w))


def tables(experiment: Experiment, runs: list[Compared]) -> None:
    print("\n| measured / by the card |", " | ".join(r.name for r in runs), "|")
    print("| --- |", " --- |" * len(runs))

    def row(name: str, digits: int, measured: list[float], predicted: list[float]) -> None:
        cells = [
            f"{a:.{digits}f} / {b:.{digits}f} ({100.0 * (b / a - 1.0):+.1f} %)"
            for a, b in zip(measured, predicted, strict=True)
        ]
        print(f"| {name} |", " | ".join(cells), "|")

    a, b = [r.measured for r in runs], [r.predicted for r in runs]
    row("settled drop, from straight [mm]", 2, [x.drop for x in a], [x.drop for x in b])
    held = [y.drop - r.held for y, r in zip(b, runs, strict=True)]
    row("settled drop, from where it was held [mm]", 2, [x.drop for x in a], held)
    row("frequency [Hz]", 3, [x.ring.frequency for x in a], [x.ring.frequency for x in b])
    row("damping ratio", 4, [x.ring.damping_ratio for x in a], [x.ring.damping_ratio for x in b])
    row("sinking, 2.0 s to the end [mm]", 3, [x.sinking for x in a], [x.sinking for x in b])
    print("| held below straight [mm] |", " | ".join(f"{r.held:.2f}" for r in runs), "|")
    print("\nAmplitude [mm], frequency [Hz], damping ratio of 2.2 periods each, from the release on:\n")
    for name, rows in swings(experiment):
        print(f"| {name} |", " | ".join(f"{a:.2f}, {f:.2f}, {z:.3f}" for a, f, z in rows), "|")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--height", type=float, default=1e3 * EDGE, help="of the load on the face [mm]")
    parser.add_argument("--cards", type=Path, help="folder for the card")
    given = parser.parse_args()
    folder = real("clamped-beam-dragonskin10", "experiment")
    experiment = experiment_of(folder, height=1e-3 * given.height)
    data, objective = measured(experiment)
    if given.cards is not None:
        found = calibrate(data)
        for e in found.estimates:
            print(f"{e.name} {e.value:.4g} ({e.low:.4g} to {e.high:.4g}) {e.unit}, {e.seen}")
        print(found, write_card(given.cards, [found], experiment))
        state = objective.state(np.array(found.u))
    else:
        state = least_squares_of(objective)
    law = objective.model.baseline.law
    print({name: float(f"{v:.4g}") for name, v in law.values(state.u[: len(law.coordinates)]).items()})
    z = objective.model.residuals([state])[0]
    print(f"chi-square {z @ z:.0f} over {objective.points} points")
    tables(experiment, compared(objective.model, state))
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as problem:
        raise SystemExit(str(problem)) from None
