"""Where an effect may sit: in all trials that it touches, or in those of one label, where these differ."""

from __future__ import annotations

from collections.abc import Sequence


def scopes(names: Sequence[str], labels: Sequence[Sequence[str]]) -> list[tuple[str, int]]:
    """Each place, and how many of its kind there are; names: of the trials touched; labels: what kinds of
    groups they are in, each a group's name a trial. A group of the same trials as one before adds nothing."""
    found, groups = [("all", 1)], [tuple(names)]
    for owners in labels:
        distinct = list(dict.fromkeys(owners))
        for owner in distinct:
            members = tuple(name for name, o in zip(names, owners, strict=True) if o == owner)
            if members not in groups:
                groups.append(members)
                found.append((owner, len(distinct)))
    return found
