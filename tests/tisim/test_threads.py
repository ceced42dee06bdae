"""`simulate` and `fields` from several threads of a process: they wait for one another."""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np

import tisim
from tisim.parallel.threads import one_thread

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=300e3)
BEAM = tisim.Beam(material=SOFT, length=0.05, axial_element_size=0.01, radial_elements=1)
MODULI = (8e3, 15e3, 30e3)
PULL = tisim.Coupon(material=SOFT, stretches=(1.1, 1.2))


def enters_in_another_thread(seconds: float) -> bool:
    entered = threading.Event()

    def enter() -> None:
        with one_thread():
            entered.set()

    thread = threading.Thread(target=enter, daemon=True)
    thread.start()
    found = entered.wait(seconds)
    if found:
        thread.join()
    return found


def test_another_thread_waits_until_this_one_has_solved() -> None:
    with one_thread():
        with one_thread():
            assert not enters_in_another_thread(0.3)
        assert not enters_in_another_thread(0.3)
    assert enters_in_another_thread(60.0)


def test_beams_on_one_mesh_from_several_threads_are_those_of_one() -> None:
    """They share a factor, which a thread overwrote while another one solved with it."""
    soft = [tisim.material_from_moduli("neo-hookean", shear_modulus=g, bulk_modulus=20 * g) for g in MODULI]
    beams = [replace(BEAM, material=material) for material in soft]
    alone = [tisim.simulate(beam, workers=1).positions for beam in beams]
    found: dict[int, list[np.ndarray]] = {}

    def solve(number: int) -> None:
        found[number] = [tisim.simulate(beams[number], workers=1).positions for _ in range(5)]

    threads = [threading.Thread(target=solve, args=(k,), daemon=True) for k in range(len(beams))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120.0)
    assert sorted(found) == [0, 1, 2]
    for number, positions in found.items():
        assert all(np.array_equal(x, alone[number]) for x in positions)


def test_a_series_of_fields_that_is_not_finished_holds_up_nobody() -> None:
    series = tisim.fields_of_frames(tisim.simulate(PULL, workers=1))
    next(series)
    assert enters_in_another_thread(60.0)
    assert next(series).frame == 1
