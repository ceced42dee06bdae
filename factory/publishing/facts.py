"""The facts on a dataset's card, all of them read from its store."""

from __future__ import annotations

import datetime
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from factory.checks.verification import FORCE_FLOOR, Verification, verify_dataset
from factory.errors import InputError
from factory.inspection import paper_table
from factory.inspection.features import Features, features, own_solves
from factory.inspection.summary import Summary, summarise
from factory.reader import Dataset, open_dataset
from factory.store.files import LEDGER, MANIFEST, DamagedError, read_json
from tisim import laws

LICENCE = "Apache-2.0"  # that of the programs (LICENSE); who publishes a dataset may choose another
AUTHOR = "The tisim authors"  # as CITATION.cff
# checks that must pass before a card is written; faults of the others are stated on it
_NEEDED = ("attributes", "files", "checksums", "shapes", "finite values")


@dataclass(frozen=True, kw_only=True)
class Moduli:
    """A material level: parameters as in the store's identity, density [kg/m3], small-strain moduli [Pa]."""

    level: str
    parameters: dict[str, Any]
    density: float
    shear: float
    bulk: float


@dataclass(frozen=True, kw_only=True)
class Worst:
    """Worst values over all frames: relative residual and force gap, smallest det F, penetration [m]."""

    residual: float
    force_gap: float
    min_jacobian: float
    penetration: float


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Times in the ledger [s]; `solves` counts its entries with times and without error."""

    solves: int
    core_seconds: float
    wall_seconds: float
    longest: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Facts:
    """Content of the card.

    Attributes
    ----------
    data : Dataset
    summary : Summary
    found : Verification
    rows : list of Features
    materials : list of Moduli
    worst : Worst
    cost : Cost or None
        None if the store has no ledger, or one without times.
    date : datetime.date or None
        Date of the store's completion.
    shown : int
        Index of the poke in the picture, the deepest.
    sums : dict of str to str
        sha256 of each file of the store, by its name.
    licence : str
    authors : tuple of str
    """

    data: Dataset
    summary: Summary
    found: Verification
    rows: list[Features]
    materials: list[Moduli]
    worst: Worst
    cost: Cost | None
    date: datetime.date | None
    shown: int
    sums: dict[str, str]
    licence: str
    authors: tuple[str, ...]

    @property
    def identity(self) -> dict[str, Any]:
        """Input on which the bytes of the store depend."""
        found: dict[str, Any] = self.data.attributes["identity"]
        return found


def gather(
    path: Path, *, licence: str = LICENCE, authors: tuple[str, ...] = (AUTHOR,), date: str | None = None
) -> Facts:
    """Check a store and read the facts of its card.

    Parameters
    ----------
    path : Path
        A finished store, or its zip.
    licence : str
        SPDX identifier.
    authors : tuple of str
    date : str, optional
        YYYY-MM-DD; default: that of the store's manifest.

    Raises
    ------
    InputError
        If an option is invalid or no poke has frames; DamagedError if the store is damaged.
    """
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9.+-]*", licence):
        raise InputError(f"--licence {licence}: expected an SPDX identifier, as Apache-2.0 or CC-BY-4.0")
    if not authors or not all(name.strip() and name.isprintable() for name in authors):
        raise InputError("--author: expected a name on one line")
    stated = None if date is None else _date(date)
    data = open_dataset(path)
    found = verify_dataset(path)
    for check in _NEEDED:
        if found.faults.get(check):
            raise DamagedError(f"{path}: the dataset is damaged ({check}): {found.faults[check][0]}")
    summary = summarise(path)
    deepest = {poke.index: float(poke.depth.max()) for poke in summary.done if len(poke.depth)}
    if not deepest:
        raise InputError(f"{path}: expected pokes with frames, found none: there is nothing to describe")
    return Facts(
        data=data,
        summary=summary,
        found=found,
        rows=features(data, summary.done),
        materials=_materials(data),
        worst=_worst(data),
        cost=_cost(summary),
        date=stated or _completed(data),
        shown=max(deepest, key=lambda index: (deepest[index], -index)),
        sums=_sums(data),
        licence=licence,
        authors=authors,
    )


def size_category(rows: int) -> str:
    """Size category of Hugging Face's dataset cards."""
    for limit, name in ((1e3, "n<1K"), (1e4, "1K<n<10K"), (1e5, "10K<n<100K"), (1e6, "100K<n<1M")):
        if rows < limit:
            return name
    return "1M<n<10M"


def beside_the_paper(facts: Facts) -> bool:
    """True if the paper's table has a row of this law and one of these material levels."""
    return any(level in paper_table.PAPER.get(facts.summary.model, {}) for level in facts.summary.levels)


def _date(text: str) -> datetime.date:
    try:
        return datetime.datetime.strptime(text, "%Y-%m-%d").date()
    except ValueError:
        raise InputError(f"--date {text}: expected a date as 2026-01-31") from None


def _completed(data: Dataset) -> datetime.date | None:
    """Date of the manifest, a store's last file; None if it was lost.

    Files in a zip, or unpacked from one, have the zip's fixed date instead.
    """
    if data.root != data.path:
        return None
    stamp = (data.path / MANIFEST).stat().st_mtime
    written = datetime.datetime.fromtimestamp(stamp, tz=datetime.UTC).date()
    return written if written.year > 1980 else None


def _materials(data: Dataset) -> list[Moduli]:
    stored = data.attributes
    found = []
    for number, level in enumerate(data.levels):
        entry = stored["identity"]["materials"][level]
        values = {key: tuple(v) if isinstance(v, list) else v for key, v in entry["parameters"].items()}
        if "shear_modulus" in stored:  # a law from outside, which need not be registered here
            shear, bulk = stored["shear_modulus"][number], stored["bulk_modulus"][number]
        else:
            moduli = laws.get(entry["law"]).moduli(values)
            shear, bulk = moduli.shear_modulus, moduli.bulk_modulus
        found.append(
            Moduli(
                level=level,
                parameters=values,
                density=float(entry["density"]),
                shear=float(shear),
                bulk=float(bulk),
            )
        )
    return found


def _worst(data: Dataset) -> Worst:
    table = data.table
    size = np.maximum(np.linalg.norm(table["rod_force"], axis=1), FORCE_FLOOR)
    return Worst(
        residual=float(table["residual"].max()),
        force_gap=float((np.linalg.norm(table["base_force"] - table["rod_force"], axis=1) / size).max()),
        min_jacobian=float(table["min_jacobian"].min()),
        penetration=float(table["penetration"].max()),
    )


def _cost(summary: Summary) -> Cost | None:
    lines = [line for line in summary.ledger.values() if not line.get("error") and "core_seconds" in line]
    if not lines:
        return None
    walls = [float(line["wall_seconds"]) for line in lines]
    return Cost(
        solves=len(lines),
        core_seconds=sum(float(line["core_seconds"]) for line in lines),
        wall_seconds=sum(walls),
        longest=max(walls),
    )


def _sums(data: Dataset) -> dict[str, str]:
    """sha256 of each file in the manifest, and of the manifest and the ledger, which it cannot list."""
    import hashlib

    content = read_json(data.root / MANIFEST)
    assert isinstance(content, dict)  # it was verified
    outside = {
        name: hashlib.sha256((data.root / name).read_bytes()).hexdigest()
        for name in (MANIFEST, LEDGER)
        if (data.root / name).is_file()
    }
    return {**content["sha256"], **outside}


def solves(facts: Facts) -> int:
    """Number of pokes that are done and have a solve of their own."""
    return int((own_solves(facts.data) & facts.data.table["done"]).sum())
