"""Next experiments for homogeneous tests: other protocols on the same specimens, direct measurements."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import CouponMode, CouponTrial
from calibration.measurements._design import Gauge, Test
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.kinematics import first_excess

Array = NDArray[np.float64]

POINTS = 50  # points of a ramp
SLOW = 0.01  # rate [1/s] if the records have no clock
FURTHER = 1.5  # factor on the strain


CouponTest = Test[Record, CouponTrial]


def made(
    r: Record, name: str, *, mode: CouponMode, top: float, ramps: int = 1, faster: float = 1.0
) -> CouponTrial:
    """Trial of a record's specimen from rest to the stretch `top`, back, and so on, `ramps` ramps in all.

    The rate is `faster` times the record's median rate; the stress error is the record's median. The stress
    is 0, to be predicted.
    """
    there = np.linspace(1.0, top, POINTS)
    stretch = np.concatenate([there if k % 2 == 0 else there[::-1] for k in range(ramps)])
    rates = r.rate[np.isfinite(r.rate)]
    rate = faster * (float(np.median(rates)) if rates.size else SLOW)
    # turning points occur twice, with a very short hold between
    steps = np.maximum(np.abs(np.diff(stretch)), 1e-6)
    return CouponTrial(
        id=f"{r.name} {name}",
        material=r.material,
        specimen=r.specimen,
        mode=mode,
        stretch=stretch,
        stress=np.zeros(stretch.size),
        time=np.concatenate([[0.0], np.cumsum(steps)]) / rate,
        stress_sd=float(np.median(r.sd)),
    )


def _furthest(r: Record) -> float:
    """Stretch of largest I1 - 3 of a record."""
    return float(r.stretch[np.argmax(first_excess(r.mode, r.stretch))])


def _mode(mode: CouponMode, *, pressed: bool = False) -> Callable[[Sequence[Record]], Sequence[CouponTrial]]:
    def trials(records: Sequence[Record]) -> Sequence[CouponTrial]:
        sides = {(r.mode, _furthest(r) < 1.0) for r in records}
        if (mode, pressed) in sides:
            return []
        r = max(records, key=lambda q: float(first_excess(q.mode, q.stretch).max()))
        reach = float(first_excess(r.mode, r.stretch).max())
        # to the same I1, so that the strain is no larger than in the earlier tests
        grid = np.linspace(0.3, 1.0, 2000) if pressed else np.linspace(1.0, 6.0, 6000)
        top = float(grid[np.argmin(np.abs(first_excess(mode, grid) - reach))])
        return [made(r, "pressed" if pressed else mode, mode=mode, top=top)]

    return trials


def _again(
    name: str, *, further: float = 1.0, ramps: int = 1, faster: float = 1.0
) -> Callable[[Sequence[Record]], Sequence[CouponTrial]]:
    def trials(records: Sequence[Record]) -> Sequence[CouponTrial]:
        return [
            made(r, name, mode=r.mode, top=_beyond(_furthest(r), further), ramps=ramps, faster=faster)
            for r in records
        ]

    return trials


def _beyond(top: float, further: float) -> float:
    return 1.0 + further * (top - 1.0) if top > 1.0 else float(top**further)


EXPERIMENTS: tuple[CouponTest | Gauge, ...] = (
    Test(name="unload", sentence="record the unloading too", trials=_again("unload", ramps=2)),
    Test(name="second-cycle", sentence="load each specimen a second time", trials=_again("again", ramps=4)),
    Test(
        name="faster", sentence="repeat the tests at ten times the rate", trials=_again("faster", faster=10.0)
    ),
    Gauge(
        name="marks",
        sentence="measure the strain by marks on the specimen itself",
        sds={"strain-offset": 0.002, "machine-compliance": 2e-9},
    ),
    Gauge(
        name="lubricate",
        sentence="lubricate the platens and repeat",
        sds={"platen-friction": 0.02, "platen-bonding": 0.02},
    ),
    Gauge(name="across", sentence="cut a specimen across and pull it as well", sds={"anisotropy": 0.03}),
    Test(
        name="further",
        sentence="go to half as much strain again",
        trials=_again("further", further=FURTHER),
    ),
    Test(
        name="twice",
        sentence="go to more than twice the strain",
        trials=_again("twice", further=FURTHER**2),
    ),
    Test(
        name="to-the-end",
        sentence="go to four times the strain, or until it locks or breaks",
        trials=_again("end", further=4.0),
    ),
    Test(name="pull", sentence="pull a strip as well", trials=_mode("uniaxial")),
    Test(name="press", sentence="press a cylinder as well", trials=_mode("uniaxial", pressed=True)),
    Test(name="shear", sentence="shear a block as well", trials=_mode("simple-shear")),
    Test(name="planar", sentence="pull a wide strip (planar) as well", trials=_mode("planar")),
    Test(
        name="equibiaxial",
        sentence="inflate or pull a sheet in two directions as well",
        trials=_mode("equibiaxial"),
    ),
)
