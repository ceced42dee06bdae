"""Homogeneous material tests with a hidden cause."""

from benchmarks.blind.coupons.cases import draw_cases, make_coupon, write
from benchmarks.blind.coupons.model import LIBRARY, OUTSIDE, Case, Hidden, Protocol

__all__ = ["LIBRARY", "OUTSIDE", "Case", "Hidden", "Protocol", "draw_cases", "make_coupon", "write"]
