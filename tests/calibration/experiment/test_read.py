"""Reading a valid experiment: SI units, complete, in the order of the file."""

from __future__ import annotations

import builtins
import io
import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from _folders import (
    beam_entry,
    capture_entry,
    coupon_entry,
    measured,
    outline_columns,
    poke_entry,
    write_experiment,
)
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from sample import PNG, sample

import tisim
from calibration.errors import InputError
from calibration.experiment import BeamTrial, CouponTrial, PokeTrial, Registration, read

# the source has 40.10 s where 41 s follows 40.9 s, as the raw files show: the time is not monotone
BROKEN_CLOCKS = {
    "silicone-tension": "Dragon-Skin-FX-Pro.csv: line 410: column time_s: expected more than 40.9 s"
}
EXPECTED = {"bench": 5, "rubber-multiaxial": 3, "silicone-compression": 1, "clamped-beam-dragonskin10": 1}


def test_everything_in_the_format_reads_as_si(tmp_path: Path) -> None:
    made = sample()
    whole = read(made.write(tmp_path))
    assert (whole.name, whole.notes, whole.folder) == ("made", "", tmp_path)
    belief = whole.materials["S0"]
    assert (belief.softener_ratio, belief.density, belief.density_sd) == (0.5, 1000.0, 5.0)
    beam, poke, coupon = whole.trials
    assert isinstance(beam, BeamTrial)
    assert (beam.id, beam.material, beam.specimen, beam.supports) == ("bar", "S0", "A", "clamped-free")
    assert beam.section == tisim.Circle(radius=0.01)
    assert (beam.free_length, beam.free_length_sd) == pytest.approx((0.1, 2e-4))
    assert (beam.grip_length, beam.section_sd, beam.marker_sd) == (0.02, pytest.approx((5e-5,)), 5e-5)
    assert (beam.gravity, beam.tip_force) == ((0.0, 0.0, -9.81), (0.0, 0.0, 0.0))
    first, second = beam.captures
    assert (first.time, second.time) == (10.0, 100.0)
    assert first.photo == tmp_path / "photos/bar.png"
    assert first.checkerboard is not None
    assert (first.checkerboard.squares, first.checkerboard.square) == ((9, 6), 0.01)
    assert (second.photo, second.checkerboard) == (None, None)
    expected = Registration(shift=1e-4, roll=math.radians(0.15), scale=0.003)
    assert first.registration == expected
    assert first.outline is not None
    assert (first.outline.sd, first.outline.correlation) == pytest.approx((1e-4, 5e-3))
    assert first.outline.registration == expected
    table = made.tables["beams/bar-t10.csv"]
    both = np.column_stack([table["x_mm"], table["z_mm"]]) / 1000
    np.testing.assert_allclose(np.vstack([first.outline.upper, first.outline.lower]), both, rtol=1e-14)
    tip, base = beam.markers
    assert (tip.name, base.name) == ("tip1", "base")
    assert tip.position == pytest.approx((0.094, 0.0, 0.015))
    np.testing.assert_array_equal(tip.time, [0.0, 0.1, 0.25])
    np.testing.assert_allclose(tip.displacement[2], [0.25e-3, 0.5e-3, -7.5e-3])
    np.testing.assert_allclose(base.displacement, 0.01 * tip.displacement)
    assert isinstance(poke, PokeTrial)
    assert poke.block == tisim.Block(
        size=(0.1, 0.1, 0.032), inclusion=tisim.SphereInclusion(radius=0.008, centre=(0.0, 0.0, 0.008))
    )
    assert (poke.rod_radius, poke.rod_tip, poke.start) == (0.0025, "flat", (0.0, 0.0, 0.032))
    assert (poke.force_sd, poke.depth_sd) == (0.01, pytest.approx(2e-5))
    np.testing.assert_allclose(poke.record.depth, [0, 2e-3, 2e-3, 1e-3])
    np.testing.assert_array_equal(poke.record.force, [0.0, 0.5, 0.45, 0.1])
    assert poke.record.force_vector is not None
    np.testing.assert_array_equal(poke.record.force_vector[1], [0.01, 0.0, 0.5])
    (scan,) = poke.surfaces
    assert (scan.time, scan.sd) == (2.0, 1e-4)
    np.testing.assert_allclose(scan.points[1], [1e-3, 4e-3, 31e-3])
    assert isinstance(coupon, CouponTrial)
    assert (coupon.mode, coupon.stretch_sd, coupon.stress_sd) == ("uniaxial", 0.002, 500.0)
    np.testing.assert_array_equal(coupon.stress, [0.0, 3000.0, 5500.0])
    assert coupon.time is not None


def test_what_is_left_out_has_the_defaults_of_the_format(tmp_path: Path) -> None:
    pull = {"id": "pull", "kind": "coupon", "material": "S0", "mode": "planar", "record": "pull.csv"}
    columns = {"nominal_stress_kPa": [1, 2, 3], "stretch": [1, 2, 3]}
    whole = read(write_experiment(tmp_path, [pull], tables={"pull.csv": columns}, materials={"S0": {}}))
    belief = whole.materials["S0"]
    assert (belief.softener_ratio, belief.density, belief.density_sd) == (None, None, 0.0)
    (trial,) = whole.trials
    assert isinstance(trial, CouponTrial)
    assert (trial.time, trial.stretch_sd, trial.stress_sd, trial.specimen) == (None, 0.0, None, None)
    np.testing.assert_array_equal(trial.stretch, [1, 2, 3])


@pytest.mark.parametrize(
    ("entry", "inclusion"),
    [
        (
            {"box": {"size_mm": [10.0, 20.0, 5.0], "centre_mm": [1.0, 2.0, 3.0], "angle_deg": 90.0}},
            tisim.BoxInclusion(size=(0.01, 0.02, 0.005), centre=(0.001, 0.002, 0.003), angle=math.pi / 2),
        ),
        (
            {"cylinder": {"radius_mm": 5.0, "height_mm": 8.0, "centre_mm": [0.0, 0.0, 4.0]}},
            tisim.CylinderInclusion(radius=0.005, height=0.008, centre=(0.0, 0.0, 0.004)),
        ),
        ({"mesh": "lump.stl"}, None),
        (None, None),
    ],
)
def test_inclusions(
    entry: dict[str, Any] | None, inclusion: tisim.bodies.Inclusion | None, tmp_path: Path
) -> None:
    made = sample()
    made.poke.pop("inclusion")
    if entry is not None:
        made.poke["inclusion"] = entry
    made.raw["lump.stl"] = b"solid"
    trial = read(made.write(tmp_path)).trials[1]
    assert isinstance(trial, PokeTrial)
    assert trial.block.inclusion == inclusion
    assert trial.inclusion_mesh == (tmp_path / "lump.stl" if entry == {"mesh": "lump.stl"} else None)


def test_a_rectangle_and_its_doubts(tmp_path: Path) -> None:
    made = sample()
    made.beam["section"] = {"rectangle": {"width_mm": 30, "height_mm": 20.0, "height_sd_mm": 0.1}}
    trial = read(made.write(tmp_path)).trials[0]
    assert isinstance(trial, BeamTrial)
    assert trial.section == tisim.Rectangle(width=0.03, height=0.02)
    assert trial.section_sd == pytest.approx((0.0, 1e-4))


def test_a_direction_comes_out_with_length_one(tmp_path: Path) -> None:
    made = sample()
    made.poke["direction"] = [3.0, 0.0, -4.0]
    trial = read(made.write(tmp_path)).trials[1]
    assert isinstance(trial, PokeTrial)
    assert trial.direction == pytest.approx((0.6, 0.0, -0.8))


@pytest.mark.parametrize("turned", ["upper", "lower", "both"])
def test_sides_traced_towards_the_clamp_are_turned_round(turned: str, tmp_path: Path) -> None:
    made = sample()
    straight = read(made.write(tmp_path / "straight")).trials[0]
    table = {key: np.asarray(values) for key, values in made.tables["beams/bar-t10.csv"].items()}
    upper = np.arange(12)[:: -1 if turned != "lower" else 1]
    lower = np.arange(12, 24)[:: -1 if turned != "upper" else 1]
    order = np.concatenate([upper, lower])
    made.tables["beams/bar-t10.csv"] = {
        "side": list(map(str, table["side"][order])),
        **{key: table[key][order] for key in ("x_mm", "z_mm")},
    }
    other = read(made.write(tmp_path / "turned")).trials[0]
    for side in ("upper", "lower"):
        sides = [getattr(t.captures[0].outline, side) for t in (straight, other)]  # type: ignore[union-attr]
        np.testing.assert_array_equal(*sides)


def test_a_contour_closed_at_its_end_and_a_beam_that_hangs_straight_down(tmp_path: Path) -> None:
    """The sides may go round the end face, which is left out, and bend beyond the vertical."""
    s = np.linspace(0.02, 1.0, 40)
    angle = 1.8 * np.minimum(2 * s, 1.0)
    way = np.cumsum(np.column_stack([np.cos(angle), -np.sin(angle)]) * 2.5, axis=0)
    normal = np.column_stack([np.sin(angle), np.cos(angle)])
    end = way[-1] + (way[-1] - way[-2])
    upper, lower = (np.vstack([way + sign * 10 * normal, end]) for sign in (1, -1))
    trial = beam_entry("bar", captures=[capture_entry(1.0, "a.csv")])
    found = read(write_experiment(tmp_path, [trial], tables={"a.csv": outline_columns(upper, lower)}))
    (beam,) = found.trials
    assert isinstance(beam, BeamTrial)
    assert beam.captures[0].outline is not None
    assert len(beam.captures[0].outline.upper) == len(beam.captures[0].outline.lower) == len(upper) - 1


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0])
def test_points_of_the_end_face_belong_to_no_side(tmp_path: Path, share: float) -> None:
    """The upper side goes round a part of it, the lower one round the rest."""
    x = np.linspace(1.0, 100.0, 60)
    upper, lower = (np.column_stack([x, sign * 10.0 - 0.002 * x**2]) for sign in (1, -1))
    face = [upper[-1] + part * (lower[-1] - upper[-1]) for part in np.linspace(0.0, 1.0, 12)[1:-1]]
    some = round(share * len(face))
    sides = np.vstack([upper, *face[:some]]), np.vstack([lower, *face[some:][::-1]])
    trial = beam_entry("bar", captures=[capture_entry(1.0, "a.csv")])
    found = read(write_experiment(tmp_path, [trial], tables={"a.csv": outline_columns(*sides)}))
    (beam,) = found.trials
    assert isinstance(beam, BeamTrial)
    outline = beam.captures[0].outline
    assert outline is not None
    for side, whole in ((outline.upper, upper), (outline.lower, lower)):
        assert len(whole) - 2 <= len(side) <= len(whole)
        np.testing.assert_allclose(1e3 * side, whole[: len(side)], atol=1e-3)


@pytest.mark.parametrize("moved", [52.0, -52.0])
def test_an_outline_of_another_origin_is_refused(tmp_path: Path, moved: float) -> None:
    x = np.linspace(1.0, 100.0, 60)
    sides = [np.column_stack([x, sign * 10.0 + moved - 0.002 * x**2]) for sign in (1, -1)]
    trial = beam_entry("bar", captures=[capture_entry(1.0, "a.csv")])
    folder = write_experiment(tmp_path, [trial], tables={"a.csv": outline_columns(*sides)})
    with pytest.raises(
        InputError, match=rf"a\.csv: column z_mm: .* z = 0, their middle is at z = {moved:g} mm"
    ):
        read(folder)


def test_numbers_with_an_exponent_and_tables_from_a_spreadsheet(tmp_path: Path) -> None:
    made = sample()
    made.raw["coupons/pull.csv"] = (
        b"\xef\xbb\xbfstretch , nominal_stress_kPa\r\n1, 0\r\n1.1,1e1\r\n1.2,20\r\n\r\n"
    )
    folder = made.write(tmp_path)
    text = (folder / "experiment.yaml").read_text()
    (folder / "experiment.yaml").write_text(text.replace("free_length_mm: 100.0", "free_length_mm: 1e2"))
    beam, _, coupon = read(folder).trials
    assert isinstance(beam, BeamTrial)
    assert isinstance(coupon, CouponTrial)
    assert beam.free_length == pytest.approx(0.1)
    np.testing.assert_array_equal(coupon.stress, [0.0, 1e4, 2e4])


def test_the_digest_follows_every_file_named_and_no_other(tmp_path: Path) -> None:
    made = sample()
    folder = made.write(tmp_path)
    before = read(folder).digest
    assert len(before) == 64
    assert read(folder).digest == before
    (folder / "truth.yaml").write_text("radius: 1")
    (folder / "notes.txt").write_text("x")
    assert read(folder).digest == before
    digests = {before}
    names = [*made.tables, *made.raw, "experiment.yaml"]
    for name in names:
        path = folder / name
        kept = path.read_bytes()
        path.write_bytes(kept + b"\n")
        digests.add(read(folder).digest)
        path.write_bytes(kept)
    assert len(digests) == len(names) + 1
    assert read(folder).digest == before
    assert made.raw["photos/bar.png"] == PNG


def test_the_truth_is_never_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = sample().write(tmp_path)
    (folder / "truth.yaml").write_text("effect: none")
    opened: list[str] = []
    real = io.open

    def watch(file: Any, *args: Any, **options: Any) -> Any:
        opened.append(str(file))
        return real(file, *args, **options)

    monkeypatch.setattr(io, "open", watch)
    monkeypatch.setattr(builtins, "open", watch)
    read(folder)
    assert any(name.endswith("experiment.yaml") for name in opened), "the watch saw nothing"
    assert not any(Path(name).name == "truth.yaml" for name in opened)


sizes = st.floats(0.1, 1e4)


@settings(max_examples=30, deadline=None)
@given(data=st.data())
def test_any_good_experiment_comes_out_a_thousandth_in_metres(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    draw = data.draw
    radius, length, grip = draw(st.floats(0.5, 50)), draw(st.floats(20, 1e3)), draw(sizes)
    count = draw(st.integers(3, 30))
    x = np.linspace(0.0, 1.0, count) ** draw(st.floats(0.5, 2)) * length
    sag = -draw(st.floats(0, 0.5)) * x**2 / length
    sides = [np.column_stack([x, sag + sign * radius]) for sign in (1, -1)]
    times = np.cumsum(draw(st.lists(st.floats(1e-3, 10), min_size=3, max_size=8)))
    block = draw(st.tuples(sizes, sizes, sizes))
    depth = draw(st.lists(st.floats(-1, 1), min_size=len(times), max_size=len(times)))
    depth = np.array(depth) * max(block)
    push = draw(st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, -0.1)))
    # a tip that leaves through a side is refused
    across = max(2.0 * abs(push[i]) / block[i] for i in range(2)) / math.hypot(*push)
    depth = np.minimum(depth, 0.999 / across if across > 0.0 else np.inf)
    assume(not 0.0 < depth.max() < 1e-3 * block[2])  # such depths look like metres, and are refused
    stress = np.array(draw(st.lists(st.floats(-1e5, 1e5), min_size=3, max_size=6)))
    for values in (depth, stress):  # all within a standard deviation: another unit, which is refused
        assume(not 0.0 < np.abs(values).max() < 1.0)
    beam = beam_entry(
        "a",
        section={"circle": {"radius_mm": radius}},
        free_length_mm=length,
        grip_length_mm=grip,
        free_length_sd_mm=0.0,
        captures=[capture_entry(float(times[0]), "o.csv")],
    )
    poke = poke_entry("b", "p.csv", block_mm=list(block), start_mm=[0.0, 0.0, block[2]], direction=list(push))
    coupon = coupon_entry("c", "c.csv")
    tables = {
        "o.csv": outline_columns(*sides),
        "p.csv": {"time_s": times, "depth_mm": depth, "force_N": depth},
        "c.csv": {"stretch": np.linspace(0.5, 3, len(stress)), "nominal_stress_kPa": stress},
    }
    folder = write_experiment(tmp_path_factory.mktemp("any"), [beam, poke, coupon], tables=tables)
    one, two, three = read(folder).trials
    assert isinstance(one, BeamTrial)
    assert isinstance(two, PokeTrial)
    assert isinstance(three, CouponTrial)
    assert isinstance(one.section, tisim.Circle)
    assert (one.section.radius, one.free_length, one.grip_length) == pytest.approx(
        (radius / 1000, length / 1000, grip / 1000), rel=1e-14
    )
    outline = one.captures[0].outline
    assert outline is not None
    np.testing.assert_allclose(outline.upper, sides[0] / 1000, rtol=1e-14, atol=1e-300)
    np.testing.assert_allclose(outline.lower, sides[1] / 1000, rtol=1e-14, atol=1e-300)
    assert two.block.size == pytest.approx(tuple(v / 1000 for v in block), rel=1e-14)
    np.testing.assert_allclose(two.record.depth, depth / 1000, rtol=1e-14, atol=1e-300)
    np.testing.assert_array_equal(two.record.time, times)
    assert math.hypot(*two.direction) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(np.cross(two.direction, push), 0.0, atol=1e-12)
    np.testing.assert_allclose(three.stress, stress * 1000, rtol=1e-14, atol=1e-300)


def test_the_shared_experiments_read() -> None:
    found: dict[str, int] = dict.fromkeys(EXPECTED, 0)
    root = measured()
    for path in sorted(root.rglob("experiment.yaml")):
        parts = path.relative_to(root).parts
        group = parts[0] if parts[0] == "bench" else parts[1]
        if group in BROKEN_CLOCKS:
            continue
        whole = read(path.parent)
        stated = yaml.safe_load(path.read_text())
        assert [trial.id for trial in whole.trials] == [trial["id"] for trial in stated["trials"]]
        assert list(whole.materials) == list(stated["materials"])
        found[group] = found.get(group, 0) + 1
    assert {group: found[group] for group in EXPECTED} == EXPECTED


@pytest.mark.parametrize("group", BROKEN_CLOCKS)
def test_shared_records_with_a_broken_clock_are_refused_and_read_without_it(
    group: str, tmp_path: Path
) -> None:
    """Time that decreases is refused (format 1); without these columns the same folder is read."""
    source = measured() / "real" / group / "experiment"
    if not source.is_dir():
        pytest.skip(f"no {group} among the measured experiments")
    with pytest.raises(InputError) as caught:
        read(source)
    assert BROKEN_CLOCKS[group] in str(caught.value)
    folder = tmp_path / group
    shutil.copytree(source, folder)
    repaired = set()
    for path in (folder / "coupons").glob("*.csv"):
        table = np.loadtxt(path, delimiter=",", skiprows=1)
        if (np.diff(table[:, 2]) <= 0).any():
            lines = path.read_text().splitlines()
            path.write_text("\n".join(line.rpartition(",")[0] for line in lines) + "\n")
            repaired.add(path.stem)
    whole = read(folder)
    assert len(whole.trials) == 19
    assert len(repaired) == 5
    assert all(isinstance(t, CouponTrial) and (t.time is None) == (t.id in repaired) for t in whole.trials)
