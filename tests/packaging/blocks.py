"""Find the command blocks of the documentation's pages, and how each is run.

A fenced block of `sh` or `python` is a command block. It is an installation block if it creates, activates or
fills a virtual environment: `.ci/run` runs these. It is slow if the paragraph before it says "not run by CI".

    python tests/packaging/blocks.py README.md install      # prints the installation blocks
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_INSTALLS = re.compile(r"\bpip install\b|-m venv\b|/activate\b")


@dataclass(frozen=True, kw_only=True)
class Block:
    """A command block of a page; `line` is the line of its opening fence."""

    page: str
    line: int
    language: str
    text: str
    slow: bool

    @property
    def installs(self) -> bool:
        return self.language == "sh" and _INSTALLS.search(self.text) is not None

    @property
    def name(self) -> str:
        return f"{self.page}:{self.line}"

    def command(self, python: str) -> list[str]:
        """Arguments of the process that runs the block; a shell block stops at the first failing command."""
        if self.language == "python":
            return [python, "-c", self.text]
        return ["sh", "-e", "-c", self.text]


def blocks(page: str) -> list[Block]:
    """Return all command blocks of a page, in order."""
    text = (ROOT / page).read_text(encoding="utf-8")
    found = []
    for match in _FENCE.finditer(text):
        if match[1] in ("sh", "python"):
            before = text[: match.start()].rstrip().rpartition("\n\n")[2]
            line = text.count("\n", 0, match.start()) + 1
            slow = "not run by CI" in " ".join(before.split())
            found.append(Block(page=page, line=line, language=match[1], text=match[2], slow=slow))
    return found


if __name__ == "__main__":
    page, _ = sys.argv[1:]
    print("\n".join(b.text.strip() for b in blocks(page) if b.installs))
