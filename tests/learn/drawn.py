"""What a picture shows, read from its pixels: for tests that draw (see `tests.unrendered`)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image


def assert_drawn(path: Path, *colours: str) -> None:
    """Assert that a PNG has a white margin, so that no text is cut off, and pixels of these colours, #rrggbb.

    The margin is one pixel wide; of each colour there are 20 pixels or more, to 24 of 255 (a thin line is
    blended with its background).
    """
    with Image.open(path) as file:
        shown = np.asarray(file.convert("RGB")).astype(int)
    assert min(shown.shape[:2]) > 200, (path, shown.shape)
    edges = np.concatenate([shown[0], shown[-1], shown[:, 0], shown[:, -1]])
    assert (edges == 255).all(), f"{path}: drawn to the edge, where it is cut off"
    for colour in colours:
        wanted = np.array(bytearray.fromhex(colour.removeprefix("#")))
        found = int((np.abs(shown - wanted) <= 24).all(axis=2).sum())
        assert found >= 20, f"{path}: {found} pixels of {colour}"
