"""What a page of a report shows."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path


class Page(HTMLParser):
    """Parts of a page that tests check.

    Attributes
    ----------
    raw : the file as text.
    words : pieces of text, in order.
    values, shown : values of <data>, and the last text in each, by its value.
    sources, links : images, and targets of links.
    tags, attributes : names of all tags and attributes.
    rows : cells of the table rows.
    verdict : class of the verdict, beside "verdict"; "" without one.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.words: list[str] = []
        self.values: list[float] = []
        self.shown: dict[float, str] = {}
        self.sources: list[str] = []
        self.links: list[str] = []
        self.tags: set[str] = set()
        self.attributes: set[str] = set()
        self.rows: list[list[str]] = []
        self.verdict = ""
        self._cell = False
        self._value: float | None = None
        self.raw = path.read_text(encoding="utf-8")
        self.feed(self.raw)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())

    def row(self, first: str) -> list[str]:
        """First table row whose first cell is `first`."""
        return next(r for r in self.rows if r and r[0] == first)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.tags.add(tag)
        self.attributes |= set(found)
        if tag == "data":
            self._value = float(found["value"] or "nan")
            self.values.append(self._value)
        if tag == "tr":
            self.rows.append([])
        if tag == "td":
            self.rows[-1].append("")
            self._cell = True
        if tag == "p" and (found.get("class") or "").startswith("verdict "):
            self.verdict = (found["class"] or "").split()[1]
        self.sources += [v for k, v in attrs if k == "src" and v]
        self.links += [v for k, v in attrs if k == "href" and v]

    def handle_endtag(self, tag: str) -> None:
        self._cell = self._cell and tag != "td"
        if tag == "data":
            self._value = None

    def handle_data(self, data: str) -> None:
        self.words.append(data)
        if self._value is not None:
            self.shown[self._value] = data
        if self._cell:
            self.rows[-1][-1] = (self.rows[-1][-1] + data).strip()
