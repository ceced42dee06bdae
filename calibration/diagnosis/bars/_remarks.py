"""What a reader of a verdict on bars should know."""

from __future__ import annotations

from collections.abc import Sequence

from calibration.diagnosis.bars._record import FIRST, Record


def remarks_on(records: Sequence[Record], near: bool) -> list[str]:
    """Sentences: what was left out, what was taken for granted, what the verdict is good for."""
    found = [
        f"of each trial the first {FIRST:g} periods after the release are left out, since no hand lets go in"
        " an instant; where and when it let go is free",
        "displacements across the plane of the swing are not compared; a twist of the tip is a nuisance",
    ]
    if near:
        names = sorted({n for r in records for n, c in zip(r.names, r.near & ~r.inside, strict=True) if c})
        found.append(
            f"markers next to the clamp ({', '.join(names)}) may sit on it: the part by which they go with it"
            " is free, and only their motion is compared, not where they settle"
        )
    silent = [
        r.name for r in records if any(r.held[i, 0] != r.held[i, 0] for i, c in enumerate(r.near) if not c)
    ]
    if silent:
        found.append(
            f"{', '.join(silent)}: no sample before the release, so where markers are counted from is"
            " not known"
        )
    found.append(
        "a fault of rig or cameras, where one is named, is on record in cards/rig.yaml, which no command"
        " reads: calibration.fit --rig corrects outlines of photographed beams"
    )
    return found
