"""Rules of what the loadings of records must show, for all kinds of tests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from calibration.diagnosis.effects._identifiable import (
    compared_with_others,
    different_rates,
    loads_again,
    unloads,
)
from calibration.diagnosis.effects.homogeneous import EFFECTS as COUPONS
from calibration.diagnosis.effects.indentation import EFFECTS as POKES


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """A record with the rates of its loadings [1/s]."""

    name: str
    material: str = "M"
    unloads: bool = False
    reloaded: bool = False
    rates: tuple[float, ...] = ()


A, B = Record(name="a"), Record(name="b")


@pytest.mark.parametrize(
    ("rule", "shown", "not_shown"),
    [
        (unloads, replace(B, unloads=True), replace(B, reloaded=True)),
        (loads_again, replace(B, reloaded=True), replace(B, unloads=True)),
    ],
)
def test_an_unloading_or_second_loading_counts_where_the_candidate_reaches(
    rule: Callable[..., bool], shown: Record, not_shown: Record
) -> None:
    assert rule([A, shown], [A, shown])
    assert not rule([A], [A, shown])
    assert not rule([A, not_shown], [A, not_shown])


def test_another_record_is_one_of_the_same_material_and_another_trial() -> None:
    assert compared_with_others([A], [A, B])
    assert not compared_with_others([A, B], [A, B])
    assert not compared_with_others([A], [A, replace(B, material="other")])
    # points of a record held out make a copy, which is no other test
    assert not compared_with_others([A], [replace(A)])


@pytest.mark.parametrize(
    ("rates", "expected"),
    [
        ([(1.0,), (1.6,)], True),
        ([(1.0,), (1.4,)], False),
        ([(1.0, 1.6)], True),
        ([(1.0, np.nan), (np.nan,)], False),
        ([(np.nan,)], False),
    ],
)
def test_two_rates_differ_by_half(rates: list[tuple[float, ...]], expected: bool) -> None:
    records = [replace(A, rates=r) for r in rates]
    assert different_rates(records, lambda r: np.array(r.rates)) is expected


def test_rates_of_two_materials_are_not_compared() -> None:
    records = [replace(A, rates=(1.0,)), replace(B, material="other", rates=(9.0,))]
    assert not different_rates(records, lambda r: np.array(r.rates))


def test_coupons_and_indentations_have_one_rule_for_each_idea() -> None:
    assert COUPONS["mullins"].identifiable is POKES["mullins"].identifiable
    assert COUPONS["hysteresis"].identifiable is POKES["adhesion"].identifiable
    assert COUPONS["gauge-length"].identifiable is POKES["force-gain"].identifiable
