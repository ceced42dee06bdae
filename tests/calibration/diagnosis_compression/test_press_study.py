"""The tables of studies/compression/diagnosis.md, of made cylinders: no other test runs what prints them."""

from __future__ import annotations

import numpy as np
from diagnosis_press_cases import bonded, experiment, pressed

from studies.compression.diagnosis_table import deviations, diagnosed, left_over, only, table


def test_the_tables_name_bonded_platens() -> None:
    both = experiment(*(pressed(f"{m}-1", bonded(), material=m) for m in ("soft", "hard")))
    found, model = diagnosed(only(both, "soft"), 0.4)
    assert [r.name for r in model.records] == ["soft-1"]
    title, sentences, head, baseline, best, *_ = table(found, model, "soft")
    assert title == f"\nsoft: found; {model.points} points"
    assert sentences.startswith("Found: the platens restrain")
    assert [line.count("|") for line in (head.splitlines()[-1], baseline, best)] == [5, 5, 5]
    assert best.startswith("| platen-bonding 1")
    explanation = found.finding.explanations[0]
    (_, row, _) = deviations(model, explanation)
    assert row.startswith("| soft-1 |")
    free, held = (left_over(model, fit)["soft-1"] for fit in (found.finding.baseline, explanation.fit))
    assert np.array_equal(free[0], held[0])
    assert 0.02 < held[0].min() < held[0].max() <= 0.4
    # noise is 0.3 % of the largest stress, some 3 % of that at a strain of 0.1
    before, after = (np.abs(left[strain > 0.1]).max() for strain, left in (free, held))
    assert after < 0.04
    assert after < 0.6 * before
