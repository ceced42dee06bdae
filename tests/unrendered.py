"""A fixture for tests of commands that draw pictures beside what the test states: half a core-second each."""

from __future__ import annotations

from pathlib import Path
from typing import IO, Any

import pytest
from matplotlib.figure import Figure
from PIL import Image
from PIL.PngImagePlugin import PngInfo


@pytest.fixture
def unrendered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are composed and saved as ever, with their metadata, but as one pixel."""
    unrender(monkeypatch)


def unrender(patch: pytest.MonkeyPatch) -> None:
    """As the fixture of this module, for a fixture of a module's or package's scope."""

    def save(
        _: Figure, file: Path | IO[bytes], *, metadata: dict[str, str] | None = None, **_options: Any
    ) -> None:
        about = PngInfo()
        for key, value in (metadata or {}).items():
            about.add_text(key, value)
        Image.new("L", (1, 1)).save(file, format="PNG", pnginfo=about)

    patch.setattr(Figure, "savefig", save)
