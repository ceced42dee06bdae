"""Stores are read as written; incomplete stores and stores in other units are refused in one sentence."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import zarr

from learn.data import MemoryDataset, open_store, split_pokes, statistics
from learn.data._files import displacement_reader
from learn.data.moduli import shear_modulus
from learn.data.store import rigid_masks
from learn.errors import InputError
from tests.learn.small_store import MODULI, write_manifest, write_store


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_store(tmp_path_factory.mktemp("store") / "small.zarr")


@pytest.fixture
def copy(whole: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(whole, tmp_path / "copy.zarr"))


def test_what_is_read_is_what_was_written(whole: Path) -> None:
    store = open_store(whole)
    assert (store.pokes, store.frames) == (12, 48)
    assert store.modulus[[0, 2]] == pytest.approx([MODULI["S0"], MODULI["S1"]])
    assert store.rod_radius == pytest.approx(2.5e-3)
    assert store.setup.rod_edge == pytest.approx(1e-3)
    np.testing.assert_allclose(store.setup.normals, np.tile([0, 0, 1.0], (1024, 1)))
    group = zarr.open_group(whole, mode="r")
    array = np.asarray(group["grid_displacement"][...]).reshape(-1, 1024, 3)  # type: ignore[index, union-attr]
    np.testing.assert_array_equal(store.displacement(slice(3, 20)), array[3:20])
    data = MemoryDataset(store, np.array([1, 30, 7]))
    np.testing.assert_array_equal(data[1].displacement[0], array[30])
    rest, triangles, moved = store.surface(4)
    assert rest.shape == (1024, 3)
    assert triangles.shape == (2 * 31 * 31, 3)
    np.testing.assert_array_equal(moved, array[16:20])


def _edit(name: str, change: Callable[[zarr.Array], None]) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        array = zarr.open_group(folder, mode="r+")[name]
        assert isinstance(array, zarr.Array)
        change(array)
        write_manifest(folder)

    return spoil


def _nan(array: zarr.Array) -> None:
    values = np.asarray(array[...])
    values.reshape(-1)[5] = np.nan
    array[...] = values


def test_pokes_that_were_not_simulated_are_no_fault(copy: Path) -> None:
    """Such pokes have no frames, and zeros in the place of values."""
    group = zarr.open_group(copy, mode="r+")
    extra = {"done": False, "direction": 0.0, "path_start": 0.0, "parameter": 0.0, "frame_count": 0}
    for name, value in extra.items():
        array = group[name]
        assert isinstance(array, zarr.Array)
        array[11] = value
    for name in ("frame_poke", "depth", "rod_force", "grid_displacement"):
        array = group[name]
        assert isinstance(array, zarr.Array)
        array.resize((44, *array.shape[1:]))
    write_manifest(copy)
    store = open_store(copy)
    assert store.frames == 44
    assert np.isnan(store.modulus[11])
    assert len(split_pokes(store).train)


def _attribute(**values: object) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        zarr.open_group(folder, mode="r+").attrs.update(values)

    return spoil


def _delete(name: str) -> Callable[[Path], None]:
    return lambda folder: shutil.rmtree(folder / name)


def _cut(folder: Path) -> None:
    file = sorted((folder / "grid_displacement" / "c").rglob("*"))[-1]
    file.write_bytes(file.read_bytes()[:-100])


def _lose(folder: Path) -> None:
    sorted(p for p in (folder / "grid_displacement" / "c").rglob("*") if p.is_file())[-1].unlink()


def _take_back(folder: Path) -> None:
    """A poke of fewer frames than none, with starts that add up."""
    for name, value in {"frame_count": [-1, 9], "frame_start": [0, -1]}.items():
        _edit(name, lambda a, value=value: a.__setitem__(slice(2), value))(folder)  # type: ignore[misc]


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (_attribute(format=2), "format 1"),
        (_attribute(pokes=3), "attribute pokes is 3"),
        (_attribute(model="gum"), "law gum"),
        (_attribute(identity={}), "radius_mm"),
        (_attribute(identity={"recipe": {"rod": {"radius_mm": 2}}}), "rod.tip is missing"),
        (_attribute(identity={"recipe": {"rod": {"radius_mm": 2, "tip": "flat"}}}), "edge_radius_mm"),
        (
            _attribute(identity={"recipe": {"rod": {"radius_mm": 2, "tip": "flat", "edge_radius_mm": 3}}}),
            "expected 0 to the rod's radius",
        ),
        (_attribute(parameter_names=["c10", "c01"]), "expected a parameter mu"),
        (_delete("depth"), "array depth is missing"),
        (_edit("depth", lambda a: a.attrs.update(units="mm")), "depth: units mm, expected m"),
        (_edit("rod_force", _nan), "rod_force has a value that is not finite"),
        (_edit("frame_count", lambda a: a.__setitem__(0, 3)), "frame_start"),
        (_take_back, "frame_count has a value below 0"),
        (_edit("level_depth", lambda a: a.resize((64,))), "level_depth: 64 rows, expected 128"),
        (_edit("grid_rest", lambda a: a.resize((16, 32, 3))), "grid_rest: 16 rows, expected 32"),
        (_edit("direction", lambda a: a.__setitem__(0, [0, 0, 2])), "unit length"),
        (_edit("poke_geometry", lambda a: a.__setitem__(0, 77)), "poke_geometry"),
        (_cut, "was altered"),
        (_lose, "is missing, the store is incomplete"),
        (lambda folder: (folder / "provenance" / "manifest.json").unlink(), "manifest.json"),
        (lambda folder: (folder / "zarr.json").unlink(), "no dataset there"),
    ],
)
def test_bad_stores_are_refused_in_one_sentence(
    copy: Path, spoil: Callable[[Path], None], words: str
) -> None:
    spoil(copy)
    with pytest.raises(InputError, match=words) as caught:
        open_store(copy)
    assert str(copy) in str(caught.value) or "law" in words or "parameter" in words
    assert "\n" not in str(caught.value)


def test_nan_in_a_frame_is_named(copy: Path) -> None:
    _edit("grid_displacement", _nan)(copy)
    store = open_store(copy)
    with pytest.raises(InputError, match="frame 0 has a value that is not finite"):
        MemoryDataset(store, np.arange(4))


def test_shards_are_read_as_zarr_reads_them(tmp_path: Path) -> None:
    """Full and partial chunks and shards, and the ragged end; other layouts are read by zarr."""
    for blosc in (True, False):
        store = open_store(write_store(tmp_path / f"{blosc}.zarr", frames=5, chunk=3, shard=9, blosc=blosc))
        assert (displacement_reader(store.location) is not None) == blosc
        group = zarr.open_group(store.location, mode="r")
        array = np.asarray(group["grid_displacement"][...]).reshape(-1, 1024, 3)  # type: ignore[index, union-attr]
        assert len(array) == 60
        for first, last in ((0, 60), (0, 9), (2, 4), (3, 6), (7, 29), (54, 60), (59, 60)):
            np.testing.assert_array_equal(store.displacement(slice(first, last)), array[first:last])


def test_a_damaged_chunk_is_named_even_without_the_manifest(copy: Path) -> None:
    _cut(copy)
    store = open_store(copy, verify=False)
    with pytest.raises(InputError, match="grid_displacement: cannot be read"):
        store.displacement(slice(40, 48))


def test_a_lost_profile_is_no_homogeneous_tissue(copy: Path) -> None:
    next(path for path in (copy / "profile" / "c").rglob("*") if path.is_file()).unlink()
    with pytest.raises(InputError, match=r"profile/c/.* is missing, the store is incomplete"):
        open_store(copy, verify=False)


def test_folds_by_shape_never_share_a_shape(tmp_path: Path) -> None:
    store = open_store(write_store(tmp_path / "s.zarr", shapes=11, sites=1, frames=1))
    tested = []
    for fold in range(5):
        split = split_pokes(store, fold=fold)
        shapes = {
            part: set(store.shape[store.frame_poke[getattr(split, part)]].tolist())
            for part in ("train", "validation", "test")
        }
        assert [len(shapes[p]) for p in ("train", "validation", "test")] == [7, 2, 2]
        assert not shapes["train"] & shapes["test"]
        assert not shapes["train"] & shapes["validation"]
        assert not shapes["validation"] & shapes["test"]
        tested += sorted(shapes["test"])
    assert tested == list(range(10))
    with pytest.raises(InputError, match="expected 0 to 4"):
        split_pokes(store, fold=5)


def test_many_shapes_are_dealt_to_the_folds_in_turn(tmp_path: Path) -> None:
    """Shapes drawn kind by kind are neighbours in the store: no part may lack a kind."""
    store = open_store(write_store(tmp_path / "s.zarr", shapes=42, sites=1, frames=1))
    kind = np.repeat([0, 1, 2], [14, 12, 16])
    tested: list[int] = []
    for fold in range(5):
        split = split_pokes(store, fold=fold)
        shapes = {
            part: sorted({*store.shape[store.frame_poke[getattr(split, part)]].tolist()})
            for part in ("train", "validation", "test")
        }
        assert [len(shapes[p]) for p in ("train", "validation", "test")] == [26, 8, 8]
        assert sorted(shape for part in shapes.values() for shape in part) == list(range(42))
        assert all(set(kind[part]) == {0, 1, 2} for part in shapes.values())
        tested += shapes["test"]
    assert len(set(tested)) == 40


def test_folds_by_site_keep_softness_levels_together(whole: Path) -> None:
    store = open_store(whole)
    split = split_pokes(store, by="site")
    sites = [
        {tuple(store.path_start[p]) for p in store.frame_poke[rows]}
        for rows in (split.train, split.validation, split.test)
    ]
    assert not sites[0] & sites[2]
    assert not sites[0] & sites[1]
    assert len(split.train) + len(split.validation) + len(split.test) == store.frames


def test_any_softness_can_be_trained_on_where_levels_share_solves(tmp_path: Path) -> None:
    """Of the pokes of the levels asked for, one of each solve, whichever level was solved."""
    folder = write_store(tmp_path / "s.zarr")
    store = open_store(folder)
    seen: dict[tuple[float, ...], int] = {}
    key = np.column_stack([store.shape, store.path_start, store.direction])
    solved = [seen.setdefault(tuple(row), k) for k, row in enumerate(key)]
    group = zarr.open_group(folder, mode="r+")
    group.create_array("solved_as", data=np.array(solved, dtype=np.int32))
    group.attrs["scales_with_modulus"] = True
    write_manifest(folder)
    store = open_store(folder)
    assert store.copies.sum() == store.pokes / 2
    counts = [
        len(split_pokes(store, train_softness=levels).train) for levels in (["S0"], ["S1"], ["S0", "S1"])
    ]
    assert counts[0] == counts[1] == counts[2] > 0
    rows = split_pokes(store, train_softness=["S1"]).train
    assert set(store.softness[store.frame_poke[rows]].tolist()) == {1}


def test_training_can_be_kept_from_a_softness_and_from_depth(whole: Path) -> None:
    store = open_store(whole)
    split = split_pokes(store, train_softness=["S0"], train_depth=2.5e-3)
    assert set(store.softness[store.frame_poke[split.train]]) == {0}
    assert store.depth[split.train].max() <= 2.5e-3
    assert set(store.softness[store.frame_poke[split.test]]) == {0, 1}
    with pytest.raises(InputError, match="no softness S7"):
        split_pokes(store, train_softness=["S7"])
    with pytest.raises(InputError, match="train part of fold 0 is empty"):
        split_pokes(store, train_depth=1e-4)


def test_statistics_come_back_from_a_checkpoint_as_they_were(whole: Path) -> None:
    store = open_store(whole)
    alike = replace(store, attributes={**store.attributes, "scales_with_modulus": True})
    for some in (store, alike):
        found = statistics(MemoryDataset(some, np.arange(some.frames)).batches(64), some)
        assert (found.log_modulus_mean is None) == (some is alike)
        assert type(found)(**found.as_dict()) == found


def test_pokes_that_are_one_solve_are_trained_on_once(whole: Path) -> None:
    store = open_store(whole)
    assert not store.copies.any()
    before = split_pokes(store, fold=1)
    trained = np.unique(store.frame_poke[before.train])
    tested = np.unique(store.frame_poke[before.test])
    solved_as = np.arange(store.pokes)
    solved_as[[trained[-1], tested[-1]]] = trained[0], tested[0]
    apart = replace(store, solved_as=solved_as)
    assert not apart.copies.any()  # the displacements of their levels may differ
    alike = replace(apart, attributes={**store.attributes, "scales_with_modulus": True})
    split = split_pokes(alike, fold=1)
    assert set(store.frame_poke[split.train]) == set(trained[:-1])
    np.testing.assert_array_equal(split.test, before.test)


def test_too_few_shapes_are_an_error_that_says_what_to_do(tmp_path: Path) -> None:
    store = open_store(write_store(tmp_path / "s.zarr", shapes=2, sites=1, frames=1))
    with pytest.raises(InputError, match="split by site instead"):
        split_pokes(store)


def test_statistics_see_the_training_part_alone(whole: Path) -> None:
    store = open_store(whole)
    split = split_pokes(store, fold=1)
    found = statistics(MemoryDataset(store, split.train).batches(5), store)
    u = store.displacement(slice(0, store.frames)).astype(float)
    of = np.sqrt((u[split.train] ** 2).sum(axis=-1).mean())
    assert found.displacement == pytest.approx(of, rel=1e-6)
    assert found.displacement != pytest.approx(np.sqrt((u**2).sum(axis=-1).mean()), rel=1e-3)
    assert found.frames == len(split.train)


def test_small_strain_moduli() -> None:
    assert (
        shear_modulus("ogden", {"mu_1": 2.0, "alpha_1": 3.0, "mu_2": -1.0, "alpha_2": -2.0, "bulk": 9}) == 4
    )
    assert shear_modulus("mooney-rivlin", {"c10": 1.0, "c01": -0.25, "bulk": 9}) == 1.5
    # a locking stretch of sqrt(8) stiffens by 8.51 % (SOFA's value, ibid.)
    assert shear_modulus("arruda-boyce", {"mu": 1.0, "locking": 8**0.5}) == pytest.approx(1.0851, abs=1e-4)
    assert shear_modulus("eight-chain", {"mu": 3.0, "locking": 2.0, "bulk": 9}) == 3.0
    with pytest.raises(InputError, match="positive shear modulus"):
        shear_modulus("mooney-rivlin", {"c10": 1.0, "c01": -1.25})


def test_inclusions_are_numbered_as_sorted_rows() -> None:
    """Each distinct mask appears once, in the order of `np.unique` over rows."""
    random = np.random.default_rng(0)
    masks = np.where(random.random((5, 13, 17)) < 0.5, 255, 7).astype(np.uint8)
    profile = masks[random.integers(0, 5, 20)]
    rows, index = np.unique(profile == 255, axis=0, return_inverse=True)
    found = rigid_masks(profile)
    np.testing.assert_array_equal(found[0], rows)
    np.testing.assert_array_equal(found[1], index.reshape(-1))
