"""Fixtures for all tests of learn."""

import pytest

from learn.evaluation import predictions
from tests.unrendered import unrendered

__all__ = ["few_motions", "unrendered"]


@pytest.fixture
def few_motions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Symmetry errors of two motions in place of eight: for tests of evaluations that state nothing of them.

    A run that is evaluated takes half as long.
    """
    plain = predictions._motions
    monkeypatch.setattr(
        predictions, "_motions", lambda _rotations, *, about_normal: plain(1, about_normal=about_normal)[:1]
    )
