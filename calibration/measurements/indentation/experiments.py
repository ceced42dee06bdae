"""Next experiments for indentation: other protocols at the same contact points, other indenters, gauges."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import PokeRecord, PokeTrial
from calibration.measurements._design import Gauge, Test
from calibration.measurements.indentation._record import Record

Array = NDArray[np.float64]

POINTS = 40  # points of a stroke
SPEED = 1e-3  # speed [m/s] if a record has none
HOLD = 60.0  # duration of a hold [s]
OTHER_ROD = 1.6  # factor on the indenter's radius
SHALLOWER = 0.8  # factor on the depth with another indenter, within reach of its simulation


IndentationTest = Test[Record, PokeTrial]


def made(
    r: Record,
    name: str,
    depths: Sequence[float],
    *,
    faster: float = 1.0,
    hold: float = 0.0,
    rod: float = 1.0,
) -> PokeTrial:
    """Trial at a record's contact point, with the record's errors; its force is 0, to be predicted.

    Parameters
    ----------
    r : the record.
    name : name of the test, appended to the record's.
    depths : successive depths of the indenter, from the surface [m].
    faster : factor on the record's speed.
    hold : duration of a hold at the first depth [s].
    rod : factor on the indenter's radius.
    """
    speed = faster * _speed(r)
    times, path, now, at = [np.zeros(1)], [np.zeros(1)], 0.0, 0.0
    for n, to in enumerate(depths):
        part = np.arange(1, POINTS + 1) / POINTS
        times.append(now + part * abs(to - at) / speed)
        path.append(at + part * (to - at))
        now, at = float(times[-1][-1]), to
        if hold > 0.0 and n == 0:
            times.append(now + hold * part**2)
            path.append(np.full(POINTS, at))
            now += hold
    time, depth = np.concatenate(times), np.concatenate(path)
    g = r.geometry
    return PokeTrial(
        id=f"{r.name} {name}",
        material=r.material,
        specimen=r.specimen,
        block=g.block,
        rod_radius=rod * g.rod.radius,
        rod_tip=g.rod.tip,
        start=(g.site[0], g.site[1], g.block.size[2]),
        direction=g.direction,
        record=PokeRecord(time=time, depth=depth, force=np.zeros(time.size)),
        force_sd=float(np.median(r.own_sd * np.sqrt(r.count))),
        depth_sd=r.depth_sd,
    )


def _speed(r: Record) -> float:
    moving = r.direction != 0
    travel = float(np.abs(np.diff(r.depth))[moving[1:]].sum())
    lasts = float(np.diff(r.time)[moving[1:]].sum())
    return travel / lasts if travel > 0.0 and lasts > 0.0 else SPEED


def _again(
    name: str,
    depths: Callable[[float, float], Sequence[float]],
    *,
    faster: float = 1.0,
    hold: float = 0.0,
    rod: float = 1.0,
) -> Callable[[Sequence[Record]], Sequence[PokeTrial]]:
    """Function from records to one new trial for each.

    depths : function from the record's largest depth and the indenter's radius [m] to the depths of `made`.
    """

    def trials(records: Sequence[Record]) -> Sequence[PokeTrial]:
        return [
            made(
                r,
                name,
                depths(float(r.depth.max()), r.geometry.rod.radius),
                faster=faster,
                hold=hold,
                rod=rod,
            )
            for r in records
        ]

    return trials


EXPERIMENTS: tuple[IndentationTest | Gauge, ...] = (
    Gauge(name="known-weight", sentence="hang a known weight on the load cell", sds={"force-gain": 0.003}),
    Gauge(
        name="free-rod",
        sentence="record the free rod for a minute before and after",
        sds={"force-offset": 1e-3, "force-drift": 5e-5},
    ),
    Gauge(name="square", sentence="put a square against the rod", sds={"rod-angle": float(np.radians(0.3))}),
    Gauge(name="callipers", sentence="measure the block with callipers", sds={"thickness": 0.003}),
    Gauge(name="touch", sentence="find the first touch by a slow approach", sds={"depth-offset": 0.01e-3}),
    Test(
        name="back",
        sentence="record the way back until the rod is free",
        trials=_again("back", lambda top, radius: (top, -0.3 * radius)),
    ),
    Test(
        name="twice",
        sentence="poke each place twice to the same depth",
        trials=_again("twice", lambda top, radius: (top, -0.3 * radius, top)),
    ),
    Test(
        name="hold",
        sentence="hold the rod at the deepest depth for a minute",
        trials=_again("hold", lambda top, _: (top,), hold=HOLD),
    ),
    Test(
        name="faster",
        sentence="repeat the pokes ten times as fast",
        trials=_again("faster", lambda top, _: (top,), faster=10.0),
    ),
    Test(
        name="other-rod",
        sentence="poke the same places with a rod 1.6 times as wide",
        trials=_again("other rod", lambda top, _: (SHALLOWER * top,), rod=OTHER_ROD),
    ),
    Gauge(name="powder", sentence="powder the rod and poke the same place again", sds={"friction": 0.1}),
    Gauge(
        name="ultrasound",
        sentence="look at the inclusion by ultrasound",
        sds={"inclusion-misplaced": 0.5e-3, "inclusion-debonded": 0.1},
    ),
)
