"""The table of README.md: every real set diagnosed by the command:  python -m studies.gallery

Each diagnosis may take MINUTES of a core; those that --out holds already are not made again. --only NAME
restricts it. The measured data are in real/ of the folder that TISIM_MEASURED names.
"""

from __future__ import annotations

import argparse
import datetime
import json
import resource
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.measured import real
from studies.pages import insert

PAGE = Path(__file__).with_name("README.md")
MINUTES = 5.0
LAW = frozenset({"law-form", "limited-extensibility", "strain-stiffening", "second-invariant"})
PLATENS = frozenset({"platen-bonding", "platen-friction"})
TESTS = frozenset({"set-between-tests", "test-order"})


@dataclass(frozen=True, kw_only=True)
class Set:
    """One experiment.

    Attributes
    ----------
    name, folder : for people, and below real/.
    source : whose.
    expert : what somebody who knows the material would say, from the sources and the literature.
    causes : the catalogue's names for that. against : names that the source contradicts.
    """

    name: str
    folder: str
    source: str
    expert: str
    causes: frozenset[str]
    against: frozenset[str] = frozenset()


SETS = (
    Set(
        name="Treloar's rubber",
        folder="rubber-multiaxial/treloar-1944",
        source="Treloar 1944",
        expert="chains of finite length; at medium strain the second invariant too",
        causes=LAW,
        against=frozenset({"anisotropy", "machine-compliance"}),
    ),
    Set(
        name="Kawabata's rubber",
        folder="rubber-multiaxial/kawabata-1981",
        source="Kawabata 1981",
        expert="the law's form: softens before it stiffens",
        causes=LAW,
        against=frozenset({"anisotropy", "machine-compliance"}),
    ),
    Set(
        name="unfilled silicone rubber",
        folder="rubber-multiaxial/meunier-2008-silicone",
        source="Meunier 2008",
        expert="the law's form; some compression between platens",
        causes=LAW,
        against=frozenset({"anisotropy"}),
    ),
    Set(
        name="PDMS network",
        folder="brain-and-gel-coupons/kawamura-2001-pdms",
        source="Kawamura 2001",
        expert="the second invariant; compression 6 to 22 % above equibiaxial tension: friction of platens",
        causes=LAW | PLATENS | {"tension-compression-asymmetry"},
        against=frozenset({"anisotropy"}),
    ),
    Set(
        name="polymer gel",
        folder="brain-and-gel-coupons/katashima-2012-gel",
        source="Katashima 2012",
        expert="chains of finite length, coupling of two directions",
        causes=LAW,
        against=frozenset({"anisotropy"}),
    ),
    Set(
        name="human brain",
        folder="brain-and-gel-coupons/budday-2017-brain",
        source="Budday 2017",
        expert="stiffer in compression than in tension; stiffens in shear (Ogden with a negative exponent)",
        causes=frozenset({"law-form", "tension-compression-asymmetry"}),
        against=frozenset({"machine-compliance"}),
    ),
    *(
        Set(
            name=f"Ecoflex 00-{n} mixtures, pressed",
            folder=f"phantom-compression/ef{n}",
            source="Dawood 2026",
            expert="rough or bonded platens; five tests in a row that stiffen where nothing is diluted",
            causes=PLATENS | TESTS,
            against=frozenset({"machine-compliance", "anisotropy"}),
        )
        for n in (10, 30, 50)
    ),
    Set(
        name="Ecoflex cylinders, pressed",
        folder="silicone-compression/experiment",
        source="Dawood 2026",
        expert="rough or bonded platens; five tests in a row that stiffen",
        causes=PLATENS | TESTS,
        against=frozenset({"machine-compliance", "anisotropy"}),
    ),
    Set(
        name="19 silicones, pulled to failure",
        folder="silicone-tension/experiment",
        source="Marechal 2020",
        expert="the law's form (Ogden); strain from the crosshead",
        causes=LAW | {"gauge-length"},
        against=frozenset({"machine-compliance"}),
    ),
    Set(
        name="Dragon Skin bar, released",
        folder="clamped-beam-dragonskin10/experiment",
        source="Dubied 2022",
        expert="a second relaxation time, or creep: it goes on sinking by 8 % after it has settled",
        causes=frozenset({"relaxation-branch", "relaxation", "creep"}),
    ),
)


def diagnosed(one: Set, out: Path, minutes: float) -> dict[str, Any]:
    """The content of diagnosis.json, with the seconds of the whole command; why there is none ("missing")."""
    there = out / one.folder.replace("/", "-")
    path = there / "diagnosis.json"
    spent = there.with_suffix(".seconds")
    if not path.exists() and minutes <= 0.0:
        return {"missing": "not made yet"}
    if not path.exists():
        command = [sys.executable, "-m", "calibration.diagnose", str(real(*one.folder.split("/")))]
        command += ["--out", str(there), "--workers", "1", "--leave-out-rows", "--overwrite"]
        limit = int(60 * minutes)
        # processor time: a machine that does other work as well makes no difference
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        ended = subprocess.run(
            command,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)),
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if ended.returncode in (-signal.SIGKILL, -signal.SIGXCPU):
            return {"missing": f"not done in {minutes:g} minutes"}
        if not path.exists():
            return {"missing": (ended.stderr or ended.stdout).strip()[-200:]}
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        spent.write_text(f"{seconds:.0f}\n", encoding="utf-8")
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    found["seconds"] = float(spent.read_text(encoding="utf-8")) if spent.exists() else found["seconds"]
    return found


def row(one: Set, found: dict[str, Any]) -> list[str]:
    """Cells of the table."""
    if "missing" in found:
        return [one.name, one.source, found["missing"], "", "", "", "", one.expert, ""]
    sets = [set(names) for names in found["alternatives"]]
    # of several sets of causes that cannot be told apart, what all of them have is what the data tell
    told = [c for c in found["causes"] if all(c["effect"] in names for names in sets)]
    named = sorted(told or found["causes"], key=lambda c: -(c["share"] or {"value": 0.0})["value"])
    sure = {c["effect"] for c in named}
    others = [" + ".join(sorted(names - sure if told else names)) for names in sets if names - sure]
    causes = "; ".join(cause(c, shares=len(named) > 1 or bool(others)) for c in named)
    if others:
        causes += f"; beside it {' or '.join(others)}" if told else f"; or {'; or '.join(others)}"
    nearest = found.get("nearest")
    share, gain = found.get("share"), found.get("gain")
    if not found["causes"] and nearest:
        causes = "nearest: " + "; ".join(map(cause, nearest["causes"]))
        share, gain = nearest["share"], nearest["gain"]
    skill = gain.get("skill") if gain else None
    return [
        one.name,
        one.source,
        found["verdict"],
        causes,
        interval(share),
        "" if skill is None else f"{skill:.2f}",
        f"{found['seconds']:.0f}",
        one.expert,
        agrees(one, sure, sets) + ("" if told or not named else " (first of several)"),
    ]


def cause(c: dict[str, Any], *, shares: bool = False) -> str:
    """Its name and amplitude, with its own share where that is asked for."""
    own = c.get("share") if shares else None
    part = f" ({interval(own)})" if own else ""
    kind = f" ({c['kind']})" if c.get("kind") else ""
    where = "" if c["scope"] == "all" else f" of {c['scope']}"
    values = ", ".join(f"{v['value']:.3g} {name}" for name, v in c["parameters"].items())
    return f"{c['effect']}{kind}{where}: {values}{part}"


def interval(share: dict[str, Any] | None) -> str:
    if share is None:
        return ""
    ends = [share["low"], share["high"]]
    between = "" if None in ends else f" [{100 * ends[0]:.0f}, {100 * ends[1]:.0f}]"
    return f"{100 * share['value']:.0f} %{between}"


def agrees(one: Set, named: set[str], sets: Sequence[set[str]]) -> str:
    """Agreement of the named causes with an expert's. sets : sets of causes that the data cannot separate."""
    if not named:
        return "nothing named"
    if named & one.against:
        return "no"
    if not named & one.causes:
        some = sum(bool(names & one.causes) for names in sets)
        return f"open: in {some} of {len(sets)} sets" if some else "not said by the source"
    return "yes" if named <= one.causes else "in part"


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder that keeps the diagnoses")
    parser.add_argument("--only", action="append", help="part of a folder's name (several times)")
    parser.add_argument(
        "--minutes", type=float, default=MINUTES, help="of a core, each; 0: only what --out holds"
    )
    asked = parser.parse_args(arguments)
    rows = []
    for one in SETS:
        if asked.only and not any(part in one.folder for part in asked.only):
            continue
        cells = row(one, diagnosed(one, asked.out, asked.minutes))
        rows.append("| " + " | ".join(cells) + " |")
        print(rows[-1], flush=True)
    if asked.only:
        return
    head = "| data | source | verdict | causes | share | held-out skill | s | a materials expert | agree |"
    table = "\n".join([head, "| --- " * 9 + "|", *rows])
    insert(PAGE, "gallery", f"*Made {datetime.date.today().isoformat()}.*\n\n{table}")


if __name__ == "__main__":
    main()
