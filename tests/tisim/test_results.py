"""Quantities and representation of results, and the return value of simulate for a single scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import threadpoolctl

import tisim
from tisim.problems.indentation.solve import solve_poke

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=20e3, bulk_modulus=400e3)
BEAM = tisim.Beam(material=SOFT, length=0.03, axial_element_size=0.01, radial_elements=1)
COUPON = tisim.Coupon(material=SOFT, stretches=(1.2,))
POKE = tisim.Poke(material=SOFT, depth=1e-3, refinement=0.5)
PRESS = tisim.Press(material=SOFT, radius=0.01, height=0.01, refinement=0.5, stretches=(0.9,))
SWING = tisim.Beam(
    material=SOFT,
    length=0.03,
    axial_element_size=0.01,
    radial_elements=1,
    solver=tisim.Solver(method="implicit", duration=0.02),
)


@pytest.mark.parametrize(
    ("scene", "has"),
    [
        (BEAM, set()),
        (SWING, set()),
        (COUPON, {"nominal_stress"}),
        (POKE, {"rod_force", "rod_tip", "penetration"}),
        (PRESS, {"penetration", "nominal_stress"}),
    ],
    ids=["beam", "dynamic beam", "coupon", "poke", "press"],
)
def test_quantities_that_a_kind_lacks_are_none(scene: tisim.Scene, has: set[str]) -> None:
    result = tisim.simulate(scene)
    assert result.ok
    for name in ("rod_force", "rod_tip", "penetration", "nominal_stress"):
        value = getattr(result, name)
        assert (value is not None) == (name in has), name
        assert value is None or len(value) == len(result.load)


def test_one_scene_gives_one_result_and_a_list_a_list() -> None:
    one = tisim.simulate(COUPON)
    assert isinstance(one, tisim.Result)
    (same,) = tisim.simulate([COUPON])
    assert np.array_equal(one.positions, same.positions)
    assert len(tisim.simulate(iter([COUPON, COUPON]))) == 2  # type: ignore[call-overload]
    assert tisim.simulate([]) == []


@pytest.mark.parametrize("scenes", [SOFT, 3, None])
def test_what_is_no_scene_is_refused_in_one_sentence(scenes: object) -> None:
    with pytest.raises(TypeError, match="expected a scene or a sequence of scenes, got"):
        tisim.simulate(scenes)  # type: ignore[call-overload]
    with pytest.raises(ValueError, match="scene 0: expected a Beam, Poke, Coupon or Press, got"):
        tisim.simulate([scenes])  # type: ignore[list-item]


def test_a_result_prints_in_a_few_lines() -> None:
    result = tisim.simulate(POKE)
    text = repr(result)
    assert text.startswith("<Result of a Poke: status converged, mesh ")
    assert "force on the rod" in text
    assert len(text) < 300
    html = result._repr_html_()
    assert html.startswith("<table>")
    assert "largest displacement" in html
    stopped = tisim.simulate(
        tisim.Coupon(
            material=tisim.material_from_moduli("st-venant-kirchhoff", shear_modulus=3e4, bulk_modulus=12e4),
            stretches=(0.2,),
        )
    )
    assert "frames none" in repr(stopped)
    assert stopped.message in repr(stopped)


def test_a_poke_counts_its_depth_on_the_way() -> None:
    seen: list[tuple[float, int]] = []
    tisim.simulate([COUPON, POKE], workers=1, on_progress=lambda done, total: seen.append((done, total)))
    done = [d for d, _ in seen]
    assert done == sorted(done)
    assert {total for _, total in seen} == {2}
    assert done[-1] == 2
    parts = [d for d in done if d % 1.0]
    assert len(parts) >= 2, "of the poke"


def test_steps_of_a_poke_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level("DEBUG", logger="tisim"):
        solve_poke(POKE)
    assert sum("step" in r.message for r in caplog.records) >= 2


def test_a_solver_below_simulate_holds_blas_to_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two BLAS threads that wait for each other take twice the CPU time of one."""
    seen: list[int] = []

    def look(_: float) -> None:
        seen.extend(p["num_threads"] for p in threadpoolctl.threadpool_info() if p["user_api"] == "blas")

    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        solve_poke(POKE, on_step=look)
        after = [p["num_threads"] for p in threadpoolctl.threadpool_info() if p["user_api"] == "blas"]
    assert set(seen) == {1}
    assert 2 in after or threadpoolctl.threadpool_info()[0]["num_threads"] == 1  # a machine of one core


@pytest.mark.parametrize("save", [tisim.picture, tisim.write])
def test_a_folder_that_is_not_there_is_named(save, tmp_path: Path) -> None:
    result = tisim.simulate(COUPON)
    ending = "png" if save is tisim.picture else "vtu"
    with pytest.raises(FileNotFoundError, match="expected a folder that exists") as error:
        save(result, tmp_path / "nofolder" / f"x.{ending}")
    assert "nofolder" in str(error.value)


@pytest.mark.parametrize("element", ["default", "tet4", "tet10"])
def test_a_poke_is_meshed_with_the_elements_asked_for(element: tisim.scene.ElementChoice) -> None:
    """Regression test: the choice of element was once ignored, and hexahedra were used."""
    result = tisim.simulate(tisim.Poke(material=SOFT, depth=2e-4, refinement=0.5, element=element))
    assert result.ok
    assert result.mesh.kind == ("hex20" if element == "default" else element)
