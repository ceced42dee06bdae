"""A clock that runs backwards in a homogeneous test: all lines are reported, and left out on request."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from calibration import read_experiment
from calibration.errors import InputError
from calibration.experiment._files import longest_growing

YAML = """format: 1
name: pulled
materials: {A: {}}
trials:
  - {id: pull, kind: coupon, material: A, mode: uniaxial, record: pull.csv}
"""


def pulled(folder: Path, times: list[float]) -> Path:
    rows = [f"{1.0 + 0.01 * k},{0.3 * k},{t}" for k, t in enumerate(times)]
    (folder / "pull.csv").write_text("stretch,nominal_stress_kPa,time_s\n" + "\n".join(rows) + "\n")
    (folder / "experiment.yaml").write_text(YAML)
    return folder


def test_all_lines_are_said_where_it_is_refused(tmp_path: Path) -> None:
    folder = pulled(tmp_path, [0, 1, 2, 1.5, 4, 5, 4.5, 7])
    with pytest.raises(InputError, match=r"line 5: .*expected more than 2 s before it, got 1.5; .*line 8$"):
        read_experiment(folder)


def test_the_fewest_rows_are_left_out_if_asked(tmp_path: Path) -> None:
    # the clock is set back by two rows: fewer rows repeat than follow
    data = read_experiment(
        pulled(tmp_path, [0, 1, 2, 3, 4, 5, 6, 7, 6.5, 7.5, 8, 9, 10]), leave_out_rows=True
    )
    (trial,) = data.trials
    assert trial.time is not None  # type: ignore[union-attr]
    assert (np.diff(trial.time) > 0.0).all()  # type: ignore[union-attr]
    assert trial.time.size == 12  # type: ignore[union-attr]
    assert "pull.csv: time_s does not grow in lines" in data.notes
    assert read_experiment(pulled(tmp_path, [0, 1, 2, 3]), leave_out_rows=True).notes == ""


def test_a_clock_that_mostly_stands_is_refused_all_the_same(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="4 of 8 rows stand against it"):
        read_experiment(pulled(tmp_path, [3, 2, 1, 0, 4, 3.5, 5, 6]), leave_out_rows=True)


def test_the_longest_growing_run() -> None:
    for values, kept in (([1, 2, 3], [0, 1, 2]), ([5, 1, 2, 2, 3], [1, 3, 4]), ([], [])):
        found = longest_growing(np.array(values, dtype=float))
        assert len(found) == len(kept)
        assert (np.diff(np.array(values, dtype=float)[found]) > 0.0).all()
