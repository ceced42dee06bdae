"""README.md: its tables, and the picture that is drawn from them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import matplotlib
import numpy as np

from studies.corrections.bench import MIXTURES
from studies.measured import ROOT
from studies.pages import insert

matplotlib.use("Agg")
from matplotlib import pyplot as plt

PAGE = ROOT / "studies" / "corrections" / "README.md"
PICTURE = PAGE.with_name("corrections.png")


def write_table(name: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Put a table between its markers in the page."""
    lines = ["| " + " | ".join(r) + " |" for r in (head, ["---"] * len(head), *rows)]
    insert(PAGE, name, "\n".join(lines))


def read_table(name: str) -> list[list[str]]:
    """Rows of a table of the page, without its head."""
    text = PAGE.read_text(encoding="utf-8")
    body = text.partition(f"<!-- {name} -->\n")[2].partition(f"<!-- end {name} -->")[0]
    return [[c.strip() for c in line.strip("| ").split("|")] for line in body.splitlines()[2:]]


def picture() -> None:
    """Modulus error of each way, one bar a mixture."""
    cases: dict[str, dict[str, float]] = {}
    for name in ("default", "linear", "faceted", "stop"):
        for row in read_table(name):
            label = {"faceted": f"inscribed\n{row[1]}", "stop": f"stopping rule\n{row[1]}"}.get(name, row[1])
            error = row[2]
            cases.setdefault(label, {})[row[0]] = float("nan") if error == "none" else float(error)
    figure, axes = plt.subplots(figsize=(11, 4.4), layout="constrained")
    for k, mixture in enumerate(MIXTURES):
        at = np.arange(len(cases)) + 0.27 * (k - 1)
        values = [v.get(mixture, np.nan) for v in cases.values()]
        axes.bar(at, values, 0.25, color=f"C{k}", label=mixture)
        for x, value in zip(at, values, strict=True):
            if np.isnan(value):
                axes.text(x, 0, "none", rotation=90, ha="center", va="bottom", fontsize=7)
                continue
            up = value >= 0
            axes.text(x, value, f"{value:+.1f}", ha="center", va="bottom" if up else "top", fontsize=6.5)
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(-150, 30)
    axes.set_yticks([-100, -30, -10, -3, -1, 0, 1, 3, 10, 30])
    axes.yaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.set_xticks(np.arange(len(cases)), [c.replace(", ", "\n") for c in cases], fontsize=7.5)
    axes.axhline(0, color="0.3", lw=0.8)
    axes.grid(axis="y", alpha=0.3)
    axes.set_ylabel("error of the fitted shear modulus [%]")
    axes.legend(frameon=False, loc="lower left")
    figure.savefig(PICTURE, dpi=130)
    print(PICTURE.relative_to(ROOT))
