"""The section through the indenter: a surface cut by a vertical plane."""

from __future__ import annotations

import numpy as np
import pytest

from factory.inspection.figures import _cut

# a box of 2 x 4 x 3, two triangles per face
_CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-2.0, 2.0) for z in (0.0, 3.0)])
_FACES = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
_TRIANGLES = np.array([t for a, b, c, d in _FACES for t in ((a, b, c), (a, c, d))])


@pytest.mark.parametrize("degrees", [0.0, 10.0, 63.0, 90.0, -30.0, 180.0])
def test_the_section_of_a_box_is_a_rectangle(degrees: float) -> None:
    turn = np.radians(degrees)
    heading = np.array([np.cos(turn), np.sin(turn)])
    cut = _cut(_CORNERS, _TRIANGLES, heading)
    half = min(1 / max(abs(heading[0]), 1e-12), 2 / max(abs(heading[1]), 1e-12))
    assert cut[..., 0].min() == pytest.approx(-half)
    assert cut[..., 0].max() == pytest.approx(half)
    assert np.linalg.norm(cut[:, 1] - cut[:, 0], axis=1).sum() == pytest.approx(2 * (2 * half + 3))
    on_outline = (
        np.isclose(np.abs(cut[..., 0]), half) | np.isclose(cut[..., 1], 0) | np.isclose(cut[..., 1], 3)
    )
    assert on_outline.all()


def test_a_plane_beside_the_surface_cuts_nothing() -> None:
    assert _cut(_CORNERS + np.array([0.0, 5.0, 0.0]), _TRIANGLES, np.array([1.0, 0.0])).shape == (0, 2, 2)
