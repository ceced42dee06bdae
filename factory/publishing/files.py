"""The files of a dataset's card: page, tables, pictures and checksums, written together."""

from __future__ import annotations

import tempfile
from pathlib import Path

from factory.errors import InputError
from factory.inspection.features import write_features, write_softness
from factory.inspection.figures import draw_poke
from factory.publishing.facts import Facts
from factory.publishing.figures import draw_features
from factory.publishing.page import page
from factory.store.files import MANIFEST

FILES = ("card.md", "features.csv", "softness.csv", "features.png", "poke.png", "manifest.json", "SHA256SUMS")


def check_out(store: Path, out: Path, *, overwrite: bool) -> None:
    """Refuse a folder in the store, a file, or a folder that holds something unless it may be overwritten."""
    if out.resolve().is_relative_to(store.resolve()):
        raise InputError(f"--out {out}: lies in the store, which would change it: give another --out")
    if out.exists() and not out.is_dir():
        raise InputError(f"--out {out}: expected a folder, got a file")
    if out.is_dir() and any(out.iterdir()) and not overwrite:
        raise InputError(
            f"--out {out}: is not empty: give --overwrite to write the card anew, or another --out"
        )


def write_card(facts: Facts, out: Path) -> None:
    """Write the card's files (`FILES`) into a temporary folder, then move them to `out`."""
    out = out.absolute()  # "." has no name
    out.parent.mkdir(parents=True, exist_ok=True)
    # under a name drawn for it: two processes never write into the same one
    with tempfile.TemporaryDirectory(
        prefix=f".{out.name}-", dir=out.parent, ignore_cleanup_errors=True
    ) as made:
        beside = Path(made)
        data, summary = facts.data, facts.summary
        write_features(facts.rows, beside / "features.csv")
        write_softness(summary.model, summary.done, summary.levels, beside / "softness.csv")
        draw_features(facts, beside / "features.png")
        draw_poke(data.poke(facts.shown), data, beside / "poke.png")
        (beside / "manifest.json").write_bytes((data.root / MANIFEST).read_bytes())
        lines = [f"{digest}  {name}\n" for name, digest in sorted(facts.sums.items())]
        (beside / "SHA256SUMS").write_text("".join(lines), encoding="utf-8")
        (beside / "card.md").write_text(page(facts), encoding="utf-8")
        out.mkdir(exist_ok=True)
        for name in reversed(FILES):  # the page last, so that all files it refers to exist
            (beside / name).replace(out / name)
