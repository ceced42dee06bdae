"""Functions that make one part of the sample experiment invalid."""

from __future__ import annotations

from collections.abc import Callable

from sample import Sample

YAML = "experiment.yaml"
OUTLINE, RECORD, PULL = "beams/bar-t10.csv", "pokes/poke.csv", "coupons/pull.csv"
MARKERS, SCAN = "beams/bar-markers.csv", "pokes/scan.csv"

Change = Callable[[Sample], object]


def put(part: str, key: str, value: object) -> Change:
    """Set a key of the sample's beam, capture, poke or coupon; dots separate nested keys."""

    def change(s: Sample) -> None:
        target = getattr(s, part)
        *path, last = key.split(".")
        for step in path:
            target = target[step]
        target[last] = value

    return change


def drop(part: str, *keys: str) -> Change:
    def change(s: Sample) -> None:
        for key in keys:
            del getattr(s, part)[key]

    return change


def rename(part: str, old: str, new: str) -> Change:
    def change(s: Sample) -> None:
        target = getattr(s, part)
        *path, last = old.split(".")
        for step in path:
            target = target[step]
        target[new] = target.pop(last)

    return change


def cell(table: str, column: str, row: int, value: object) -> Change:
    def change(s: Sample) -> None:
        s.tables[table][column] = list(s.tables[table][column])
        s.tables[table][column][row] = value

    return change


def raw(name: str, content: bytes) -> Change:
    def change(s: Sample) -> None:
        s.raw[name] = content

    return change


def rows(table: str, chosen: list[int]) -> Change:
    def change(s: Sample) -> None:
        s.tables[table] = {key: [list(v)[k] for k in chosen] for key, v in s.tables[table].items()}

    return change


def swap_sides(s: Sample) -> None:
    names = s.tables[OUTLINE]["side"]
    s.tables[OUTLINE]["side"] = ["lower" if n == "upper" else "upper" for n in names]


def loop(s: Sample) -> None:
    for column, steps in (("x_mm", (4, 2, 2)), ("z_mm", (0, 4, -3))):
        values = list(s.tables[OUTLINE][column])
        values[5:8] = [values[4] + step for step in steps]
        s.tables[OUTLINE][column] = values


def metres(s: Sample) -> None:
    s.tables[OUTLINE] = {k: v if k == "side" else v * 1e-3 for k, v in s.tables[OUTLINE].items()}


# change, then file, location (key or line) and expectation that the error message must contain
Case = tuple[Change, str, str, str]
