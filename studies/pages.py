"""Pages with tables that a study makes: each stands between <!-- NAME --> and <!-- end NAME -->."""

from __future__ import annotations

from pathlib import Path

from tisim.io.whole import write_whole


def insert(page: Path, name: str, text: str) -> None:
    """Replace what stands between the markers of a name; SystemExit if the page lacks them."""
    begin, end = f"<!-- {name} -->\n", f"\n<!-- end {name} -->"
    before, _, rest = page.read_text(encoding="utf-8").partition(begin)
    _, found, after = rest.partition(end)
    if not found:
        raise SystemExit(f"{page}: expected the markers of {name}")
    write_whole(page, before + begin + text + end + after)
