"""What a reader of a verdict on pressed cylinders should know."""

from __future__ import annotations

from collections.abc import Sequence

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.presses._held import Held
from calibration.diagnosis.presses._pressed import LAST, is_pressed
from calibration.diagnosis.presses._wobble import TERMS, Wobble
from calibration.press import Cylinder


def remarks_on(
    records: Sequence[Record], last: float, stated: Cylinder | None, held: Held, wobble: Wobble
) -> list[str]:
    """records: before they were cut to what is compared."""
    c = held.cylinder
    size = f"{2e3 * c.radius:g} x {1e3 * c.height:g} mm"
    found = [
        f"cylinders taken as {size} (diameter x height){'' if stated else ', since the format does not say'};"
        " only the quotient counts, and only where platens hold",
        "platens that hold in part are taken between free and bonded ones, which are simulated; Coulomb"
        " friction itself is not",
    ]
    cut = [r for r in records if is_pressed(r) and 1.0 - r.stretch.min() > last]
    if cut:
        furthest = max(float(1.0 - r.stretch.min()) for r in cut)
        found.append(
            f"compared up to a strain of {last:g} only, of {furthest:.2g} measured: beyond {LAST:g}, the"
            " simulation of bonded cylinders is not good enough"
        )
    if wobble.told_by:
        known = ", ".join(f"{name} {100 * s:.2g} %" for name, s in zip(TERMS, wobble.sds, strict=True))
        found.append(
            f"{len(wobble.told_by)} repeats differ from each other smoothly ({known}): each record may"
            " deviate so much"
        )
    elif len({r.name for r in records if is_pressed(r)}) > 0:
        found.append(
            "too few repeats to tell how much one test differs from the next: no such scatter allowed"
        )
    return found
