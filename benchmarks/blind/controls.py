"""Controls of verdicts on synthetic measurements of each kind: `python -m benchmarks.blind.controls coupons`.

without: one cause of the library, removed from the catalogue; a substitute may be named only as partial.
smooth: no cause, but an unstated smooth error in each record; nothing may be named.
half: one cause of the library and one outside it, equally large; the one inside is to be named (or to be the
nearest), and the interval of its share is to contain the true one.
one, two: causes of the library; the intervals of their shares are to contain the true ones.

The true share is defined in `laboratory.py`. `--out FILE` appends each case as one line of JSON.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.blind.beams import laboratory as beams
from benchmarks.blind.compression import laboratory as compression
from benchmarks.blind.coupons import laboratory as coupons
from benchmarks.blind.indentation import laboratory as indentation
from benchmarks.blind.laboratory import Laboratory
from benchmarks.blind.record_scores import named, named_set, part
from benchmarks.blind.release import laboratory as release

LABORATORIES: dict[str, Laboratory[Any]] = {
    "beams": beams.LABORATORY,
    "coupons": coupons.LABORATORY,
    "compression": compression.LABORATORY,
    "indentation": indentation.LABORATORY,
    "release": release.LABORATORY,
}
CONTROLS = ("without", "smooth", "half", "one", "two")
SIZE = 25.0  # size of a cause in standard deviations
HALF = (0.4, 0.6)  # accepted true share of the cause inside the library, of two of that size
UNNAMED = ("none", "unexplained")
Row = dict[str, Any]


def rows(kind: str, control: str, count: int, seed: int) -> Iterator[Row]:
    """Hidden causes, verdict and the shares of both, for each case."""
    lab = LABORATORIES[kind]
    made = number = 0
    while made < count:
        number += 1
        own = 1000 * seed + number
        case = _case(lab, control, own)
        if case is None:
            continue
        made += 1
        hidden = tuple(h.name for h in lab.hidden(case))
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "experiment"
            lab.write(case, folder)
            if control == "smooth":
                lab.smooth_error(folder, own)
            began = time.process_time()
            verdict = lab.diagnose(folder, without=hidden if control == "without" else ())
            seconds = time.process_time() - began
            excused = False
            if control == "without" and verdict["verdict"] == "found":
                # an equivalent of the truth, by name or by the full catalogue's verdict, is not wrong
                excused = set(hidden) <= {h for n in named(verdict) for h in lab.same.get(n, ())}
                excused = excused or named(verdict) in named_set(lab.diagnose(folder))
        yield {
            "seed": own,
            "hidden": hidden,
            "sigma": [round(h.sigma, 1) for h in lab.hidden(case)],
            "scope": [h.where for h in lab.hidden(case)],
            "excused": excused,
            "words": sorted(n for n, h in lab.same.items() if set(hidden[:1]) & h),
            "seconds": seconds,
            "true_shares": _true_shares(lab, control, case, verdict),
            **{k: verdict[k] for k in ("verdict", "causes", "alternatives", "share", "nearest", "gain")},
        }


def _case(lab: Laboratory[Any], control: str, seed: int) -> Any:
    if control == "smooth":
        return lab.clean(seed)
    if control != "half":
        return (lab.two if control == "two" else lab.one)(seed, SIZE)
    case = lab.half(seed, SIZE)
    if case is None:
        return None
    # two causes with similar or opposite effects do not share the visible misfit equally
    inside = lab.hidden(case)[0].name
    return case if HALF[0] <= lab.true_shares(case, [inside])[inside] <= HALF[1] else None


def causes_of(verdict: Row) -> list[Row]:
    """Named causes, or the nearest ones if none is named."""
    nearest = verdict["nearest"]
    return list(verdict["causes"] or (nearest["causes"] if nearest else []))


def share_of(verdict: Row) -> Row | None:
    """Share of the named causes, or of the nearest ones if none is named."""
    nearest = verdict["nearest"]
    found: Row | None = verdict["share"] if verdict["causes"] else (nearest["share"] if nearest else None)
    return found


def _true_shares(lab: Laboratory[Any], control: str, case: Any, verdict: Row) -> dict[str, float]:
    """True shares of the named or nearest causes; empty unless all are hidden causes of the library."""
    names = {c["effect"] for c in causes_of(verdict)}
    inside = {h.name for h in lab.hidden(case)[: 1 if control == "half" else None]}
    if control == "without" or not names or not names <= inside:
        return {}
    return lab.true_shares(case, names)


def covered(row: Row) -> list[bool]:
    """True for each interval that contains the true share: of all named causes, and of each of several."""
    true = row["true_shares"]
    share = share_of(row)
    pairs = [(share, sum(true.values()))] if true else []
    if len(true) > 1:
        pairs += [(c.get("share"), true[c["effect"]]) for c in row["causes"]]
    return [s["low"] <= t <= s["high"] for s, t in pairs if s and s["low"] is not None]


def line(row: Row) -> str:
    """One line of text for a case."""
    hidden = " + ".join(f"{n} {s:g}" for n, s in zip(row["hidden"], row["sigma"], strict=True)) or "-"
    found = " + ".join(c["effect"] for c in causes_of(row))
    shown = found if row["causes"] else f"({found})"
    also = "; or ".join(" + ".join(names) for names in row["alternatives"][1:])
    share = share_of(row)
    said = f"{share['value']:.2f} [{share['low']}, {share['high']}]" if share else "-"
    true = f" true {sum(row['true_shares'].values()):.2f}" if row["true_shares"] else ""
    return (
        f"  {row['seed']} {hidden}: {row['verdict']} {shown}{'; or ' + also if also else ''}"
        f"{' (excused)' if row['excused'] else ''} share {said}{true} {row['seconds']:.1f} core-s"
    )


def scores(control: str, done: list[Row]) -> Iterator[str]:
    """Lines of text with the goals and the scores."""
    said = Counter(r["verdict"] for r in done)
    yield f"{control}: {dict(said)}"
    if control == "without":
        alone = [r["verdict"] == "found" for r in done]
        wrong = [a and not r["excused"] for a, r in zip(alone, done, strict=True)]
        yield f"  explained in part by a stand-in: {part([r['verdict'] == 'partly explained' for r in done])}"
        yield f"  another name, alone and without 'partly': goal at most 5 %, {part(wrong)}"
        yield f"  the same with other words for the truth and what is listed beside it: {part(alone)}"
        return
    if control == "smooth":
        yield f"  nothing named: goal 95 %, {part([r['verdict'] in UNNAMED for r in done])}"
        return
    inside = [r["hidden"][:1] if control == "half" else r["hidden"] for r in done]
    here = [any(set(i) <= set(s) for s in named_set(r)) for i, r in zip(inside, done, strict=True)]
    near = [set(i) <= {c["effect"] for c in causes_of(r)} for i, r in zip(inside, done, strict=True)]
    yield f"  the truth in the named set: {part(here)}"
    either = [a or b for a, b in zip(here, near, strict=True)]
    yield f"  the same, or nearest: goal 90 %, {part(either)}"
    yield f"  true share in its interval: goal 88 to 97 %, {part([c for r in done for c in covered(r)])}"
    if control == "half":
        words = [bool({c["effect"] for c in causes_of(r)} & set(r["words"])) for r in done]
        other = [a or b for a, b in zip(either, words, strict=True)]
        yield f"  the same, or another word for it: {part(other)}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("kind", choices=list(LABORATORIES))
    parser.add_argument("--control", choices=CONTROLS, action="append", help="only this (several times)")
    parser.add_argument("--cases", type=int, default=20, help="of each control")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="file to which each case is added, as a line of JSON")
    given = parser.parse_args()
    for control in given.control or CONTROLS:
        done = []
        for row in rows(given.kind, control, given.cases, given.seed):
            print(line(row), flush=True)
            done.append(row)
            if given.out:
                with given.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps({"kind": given.kind, "control": control, **row}) + "\n")
        for text in scores(control, done):
            print(text, flush=True)


if __name__ == "__main__":
    main()
