"""Indentation and hold of meat, if the data are available: see studies/indentation/meat.md."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from studies.indentation.meat import fit, predicted, read, rms

ROOT = Path(__file__).resolve().parents[3]
MEASURED = Path(os.environ.get("TISIM_MEASURED") or ROOT.parent / "shared" / "measured")
RECORDS = MEASURED / "real" / "meat-indentation-relaxation" / "records"

pytestmark = pytest.mark.skipif(
    not RECORDS.is_dir(), reason="no measured meat: set TISIM_MEASURED to the folder that holds real/"
)


def test_a_hold_is_predicted_from_the_relaxation_of_another_place() -> None:
    """The force relaxes to half; it is fitted to 0.7 %, and predicted from the same piece to 4 %."""
    here, there = (read(RECORDS / f"RDG2-1{place}.csv") for place in "CE")
    own = fit(here)
    assert rms(here, own.force) < 0.007
    elastic = predicted(here, np.zeros(len(own.fractions)))
    assert rms(here, elastic) > 0.3
    assert rms(here, predicted(here, fit(there).fractions)) < 0.04
