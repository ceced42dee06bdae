"""Homogeneous material tests (`tisim.Coupon`) as a kind of scene."""

from __future__ import annotations

from typing import Any

from tisim._checks import (
    check_choice,
)
from tisim.parts import FIELDS
from tisim.problems._checks import check_course, check_static, check_stretches, oblique_fibres
from tisim.problems._registry import OnStep, SceneKind
from tisim.result import Result
from tisim.scene import Coupon

SECONDS = 0.05  # cost of a scene [core-s]


def check(scene: Coupon) -> None:
    check_choice("mode", scene.mode, ("uniaxial", "equibiaxial", "planar", "simple-shear"))
    check_stretches(scene.stretches, scene.mode)
    check_course(scene, start=1.0, instead_of=("stretches",))
    if scene.course is not None:
        check_stretches(scene.course.values, scene.mode)
    check_static(scene.solver, "coupons")


def takes(_: Coupon) -> tuple[str, ...]:
    return tuple(FIELDS)


def mesh_key(_: Coupon) -> tuple[Any, ...]:
    return ("coupon",)


def seconds(_: Coupon) -> float:
    return SECONDS


def solve(scene: Coupon, on_step: OnStep) -> Result:
    if scene.mode != "simple-shear" and oblique_fibres(scene.material):
        from tisim.problems.homogeneous.oblique import solve_oblique

        return solve_oblique(scene, on_step=on_step)
    from tisim.problems.homogeneous.solve import solve_coupon

    return solve_coupon(scene, on_step=on_step)


def describe(result: Result, frame: int) -> str:
    scene = result.scene
    assert isinstance(scene, Coupon)
    assert result.nominal_stress is not None
    stress, load = result.nominal_stress[frame] * 1e-3, float(result.load[frame])
    driven = f"shear {load - 1.0:.3g}" if scene.mode == "simple-shear" else f"stretch {load:.3g}"
    return f"Coupon, {scene.mode}, {driven}, {stress:.3g} kPa"


KIND = SceneKind(
    scene=Coupon,
    check=check,
    takes=takes,
    mesh_key=mesh_key,
    seconds=seconds,
    solve=solve,
    describe=describe,
)
