"""learn.predict and learn.load: invalid input is refused by name; answers state if they extrapolate."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

import learn
import learn.predict
from learn.data import open_store, split_of
from learn.errors import InputError, OutsideDomainError
from learn.evaluation.intervals import Intervals
from learn.predictor import Predictor
from learn.quantities import QUANTITIES
from learn.training import load_run
from learn.training.run_folder import load_checkpoint, save_checkpoint
from learn.validity import domain_of
from tests.learn.commands import call, refused, train_small
from tests.learn.small_store import write_store

POKE = "site_mm: [5, -10]\ndepth_mm: 2\nangle_deg: 20\nheading_deg: 45\nshape: shape-1\nsoftness: S1\n"
SPHERE = "inclusion: {kind: sphere, radius_mm: 8, centre_mm: [0, 0, 8]}"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    return write_store(tmp_path_factory.mktemp("prediction") / "s.zarr", shapes=3, sites=3, frames=3)


@pytest.fixture(scope="module")
def run(store: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return train_small(store, tmp_path_factory.mktemp("run") / "run", "--epochs", 1)


@pytest.fixture(scope="module")
def predictor(run: Path) -> Predictor:
    return learn.load(run)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[5, -10]", "[.nan, -10]", "key site_mm.0: "),
        ("[5, -10]", "[5, .inf]", "key site_mm.1: "),
        ("[5, -10]", "[5, -10, 0]", "key site_mm: "),
        ("[5, -10]", "[49, 0]", "key site_mm: expected x within -47.5 to 47.5"),
        ("heading_deg: 45", "heading_deg: .nan", "key heading_deg: "),
        ("heading_deg: 45", "heading_deg: true", "key heading_deg: "),
        ("angle_deg: 20", "angle_deg: 79", "key angle_deg: expected less than or equal to 45, got 79"),
        ("angle_deg: 20", "angle_deg: .nan", "key angle_deg: "),
        ("depth_mm: 2", "depth_mm: true", "key depth_mm: expected a valid number, got True"),
        ("depth_mm: 2", "depth_mm: '2'", "key depth_mm: expected a valid number, got '2'"),
        ("depth_mm: 2", "depth_mm: 002", "key depth_mm: expected a valid number, got '002'"),
        ("depth_mm: 2", "depth_mm: 0x2", "key depth_mm: expected a valid number, got '0x2'"),
        (
            "heading_deg: 45",
            "heading_deg: 1:30",
            "key heading_deg: expected a valid number, got '1:30'",
        ),
        ("depth_mm: 2", "depth_mm: 0", "key depth_mm: expected greater than 0, got 0"),
        ("depth_mm: 2", "depth_mm: .nan", "key depth_mm: "),
        ("depth_mm: 2", "depth_mm: .inf", "key depth_mm: "),
        (
            "depth_mm: 2",
            "depth_mm: 900",
            "key depth_mm: expected less than the block's height of 32 mm, got 900",
        ),
        ("depth_mm: 2", "depth_mm: [2]", "key depth_mm: "),
        ("depth_mm: 2", "depth: 2", "key depth: no such key; key depth_mm: this key is missing"),
        ("softness: S1", "shear_modulus_kPa: .nan", "key shear_modulus_kPa: "),
        ("softness: S1", "softness: 3", "key softness: "),
        (
            "shape: shape-1",
            SPHERE.replace("radius_mm: 8", "radius_mm: .nan"),
            "key inclusion.radius_mm: ",
        ),
        ("shape: shape-1", SPHERE.replace("[0, 0, 8]", "[0, .nan, 8]"), "key inclusion.centre_mm.1: "),
        ("shape: shape-1", SPHERE.replace("[0, 0, 8]", "[60, 0, 8]"), "within the block, x -50 to 50 mm"),
        ("shape: shape-1", SPHERE.replace("[0, 0, 8]", "[0, 0, 30]"), "within the block, z 0 to 32 mm"),
        ("shape: shape-1", SPHERE.replace("[0, 0, 8]", "[0, 0, -9]"), "within the block, z 0 to 32 mm"),
        ("shape: shape-1", SPHERE.replace("radius_mm: 8", "radius_mm: 80"), "within the block"),
        (
            "shape: shape-1",
            SPHERE.replace("sphere", "cone"),
            "key inclusion.kind: expected one of 'sphere', ",
        ),
        ("shape: shape-1", "inclusion: {radius_mm: 8}", "key inclusion.kind: this key is missing"),
        ("shape: shape-1", "inclusion: sphere", "key inclusion: expected keys and values, got 'sphere'"),
        ("site_mm: [5, -10]", "site_mm: 5", "key site_mm: expected a list, got 5"),
        ("site_mm: [5, -10]", "site_mm: [5]", "key site_mm: expected more values, got 1"),
        ("site_mm: [5, -10]", "site_mm: [5, 1, 2]", "key site_mm: expected at most 2 values, got 3"),
        (
            "shape: shape-1",
            "inclusion: {kind: none}\nblock_mm: [4, 90, 30]",
            "key block_mm: expected sides of the indenter's diameter, 5 mm, or more, got 4 x 90",
        ),
        (
            "depth_mm: 2\nangle_deg: 20\nheading_deg: 45\nshape: shape-1",
            "depth_mm: 5\n" + SPHERE.replace("[0, 0, 8]", "[5, -10, 20]"),
            "key depth_mm: expected less than 4.25 mm, where the tip would be within the rigid inclusion",
        ),
        ("shape: shape-1\n", "", "expected either shape or inclusion"),
    ],
)
def test_nonsense_is_refused_by_name(run: Path, tmp_path: Path, old: str, new: str, words: str) -> None:
    scene = tmp_path / "poke.yaml"
    assert old in POKE
    scene.write_text(POKE.replace(old, new))
    refused(call(learn.predict.app, run, scene, "--out", tmp_path / "out"), str(scene), words)
    assert not (tmp_path / "out").exists()


BOMB = "a: &a [1,1,1,1,1,1,1,1,1]\n" + "".join(
    f"{k}: &{k} [{','.join([f'*{j}'] * 9)}]\n" for j, k in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (BOMB, "expected no alias"),
        ("a: &a [*a]\n", "expected no alias"),
        ("site_mm: " + "[" * 5000 + "]" * 5000, "nested deeper"),
        (POKE + "depth_mm: 3\n", "key depth_mm: stands twice"),
        (POKE + "{", "not YAML"),
        (POKE.replace("depth_mm: 2", "depth_mm: 2024-13-45"), "key depth_mm: "),
        (POKE.replace("depth_mm: 2", "depth_mm: " + "9" * 6000), "not YAML"),
        (POKE.replace("depth_mm: 2", "depth_mm: !!python/name:os.system"), "not YAML"),
        ("[1, 2]", "expected keys and values"),
        ("", "expected keys and values"),
        ("? [1, 2]\n: 3\n", "not YAML"),
        ("1: 2\n", "key 1: "),
        ("x" * 1_100_000, "expected at most"),
    ],
    ids=[
        "bomb", "cycle", "nesting", "duplicate", "torn", "bad date", "huge integer", "python", "list",
        "empty", "list as key", "number as key", "large",
    ],
)  # fmt: skip
def test_yaml_that_is_no_scene_is_one_sentence(run: Path, tmp_path: Path, text: str, words: str) -> None:
    scene = tmp_path / "poke.yaml"
    scene.write_text(text)
    refused(call(learn.predict.app, run, scene, "--out", tmp_path / "out"), str(scene), words)


def _edges(run: Path) -> dict[str, tuple[float, float]]:
    domain = load_run(run).domain
    assert domain is not None
    return domain.ranges


def test_the_domain_is_that_of_the_training_part(run: Path, store: Path) -> None:
    opened, loaded = open_store(store), load_run(run)
    rows = split_of(opened, loaded.recipe).train
    assert loaded.domain == domain_of(opened, rows)
    ranges = _edges(run)
    assert ranges["depth_mm"] == pytest.approx((1.0, 2.0))  # the recipe trains to 2.5 mm
    angle = np.degrees(np.arccos(-opened.direction[opened.frame_poke[rows], 2]))
    assert ranges["angle_deg"] == pytest.approx((angle.min(), angle.max()))
    assert ranges["shear_modulus_kPa"] == pytest.approx((9, 30))
    assert ranges["block_z_mm"] == pytest.approx((32, 32))
    assert ranges["block_x_mm"] == pytest.approx((100, 100))
    assert ranges["rod_radius_mm"] == pytest.approx((2.5, 2.5))
    assert ranges["inclusion_height_mm"][1] <= 32 - 12 + 0.3
    assert set(ranges) == set(QUANTITIES)


def _outside(predictor: Predictor, **changes: object) -> set[str]:
    """Keys of the checks that are outside, for a poke amid the trained ranges with these changes."""
    ranges = predictor.domain.ranges if predictor.domain else {}
    middle = {key: sum(ranges[key]) / 2 for key in ("depth_mm", "angle_deg", "shear_modulus_kPa")}
    scene: dict[str, object] = {"site_mm": [0, 0], "shape": "shape-2", **middle, **changes}
    return {check.key for check in predictor.predict(scene).outside}


def test_each_quantity_is_checked_on_its_own(predictor: Predictor) -> None:
    plain = _outside(predictor)
    assert plain <= {"cover_mm", "depth_over_cover", "inclusion_width_mm", "inclusion_height_mm"}
    for changes, key in [
        ({"depth_mm": 4.0}, "depth_mm"),
        ({"depth_mm": 0.3}, "depth_mm"),
        ({"angle_deg": 45}, "angle_deg"),
        ({"shear_modulus_kPa": 100}, "shear_modulus_kPa"),
        ({"site_mm": [46, 0]}, "site_to_side_mm"),
    ]:
        assert _outside(predictor, **changes) - plain - {"depth_over_cover"} == {key}, changes


def test_thin_cover_and_other_inclusions_are_outside(predictor: Predictor) -> None:
    thin = {"kind": "cylinder", "radius_mm": 9, "height_mm": 28, "centre_mm": [0, 0, 14]}
    outside = _outside(predictor, shape=None, inclusion=thin)
    assert {"cover_mm", "inclusion_height_mm"} <= outside
    none = predictor.predict(
        {"site_mm": [0, 0], "depth_mm": 2, "softness": "S0", "inclusion": {"kind": "none"}}
    )
    assert "inclusion_width_mm" in {check.key for check in none.outside}
    kind = next(check for check in none.checks if check.key == "inclusion")
    assert kind.inside is None  # this dataset does not state the kinds of its shapes


@pytest.mark.usefixtures("unrendered")
def test_the_command_says_so_and_strict_refuses(run: Path, tmp_path: Path) -> None:
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE.replace("depth_mm: 2", "depth_mm: 9"))
    done = call(learn.predict.app, run, scene, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    flat = " ".join(done.output.split())
    assert "Far outside the trained ranges: depth (9 mm; trained: 1 to 2 mm; beyond by 699 % of the" in flat
    assert flat.count("depth (9 mm") + flat.count("depth 9 mm") == 1  # said once
    answer = json.loads((tmp_path / "out" / "prediction.json").read_text())
    assert answer["inside_training"] is False
    depth = answer["domain"]["depth_mm"]
    assert depth == {
        "value": pytest.approx(9.0),
        "trained": "1 to 2 mm",
        "inside": False,
        "beyond": pytest.approx(6.988),
    }
    beyond = [one["beyond"] for one in answer["domain"].values()]
    assert answer["distance_from_training"] == pytest.approx(np.linalg.norm(beyond))
    assert set(answer["domain"]) == {*QUANTITIES, "inclusion"}
    strict = call(learn.predict.app, run, scene, "--strict", "--out", tmp_path / "strict")
    refused(strict, str(scene), "--strict", "depth (9 mm; trained: 1 to 2 mm; beyond by")
    assert not (tmp_path / "strict").exists()


def test_a_trained_poke_is_inside(run: Path, store: Path) -> None:
    """The scene of every training poke is inside, and strict mode predicts it."""
    opened, predictor = open_store(store), learn.load(run)
    rows = split_of(opened, predictor.run.recipe).train
    for poke in np.unique(opened.frame_poke[rows]):
        direction = opened.direction[poke]
        scene = {
            "site_mm": [float(v) * 1e3 for v in opened.path_start[poke][:2]],
            "depth_mm": 2.0,
            "angle_deg": float(np.degrees(np.arccos(-direction[2]))),
            "heading_deg": float(np.degrees(np.arctan2(direction[1], direction[0]))),
            "shape": opened.shapes[opened.shape[poke]],
            "softness": opened.softness_names[opened.softness[poke]],
        }
        answer = predictor.predict(scene, strict=True)
        assert answer.inside, answer.verdict


def test_runs_from_before_the_domain_was_recorded(run: Path, tmp_path: Path) -> None:
    """The domain is derived from the dataset if it is available, else reported as unknown."""
    old = tmp_path / "old"
    old.mkdir()
    content = load_checkpoint(run / "best.pt")
    recorded = content.pop("domain")
    save_checkpoint(old / "best.pt", content)
    assert load_run(old).domain is None
    predictor = learn.load(old)
    assert predictor.domain is not None
    assert predictor.domain.model_dump(mode="json") == recorded
    predictor.domain = None
    answer = predictor.predict({"site_mm": [0, 0], "depth_mm": 2, "shape": "shape-1", "softness": "S0"})
    assert answer.inside is None
    assert "trained ranges are not known" in answer.verdict
    with pytest.raises(OutsideDomainError, match="not known"):
        predictor.predict(answer.poke, strict=True)


@pytest.mark.usefixtures("unrendered")
def test_the_python_interface(run: Path, predictor: Predictor, tmp_path: Path) -> None:
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE)
    answer = predictor.predict(scene)
    assert answer.displacement.shape == answer.points.shape == (1024, 3)
    assert answer.force > 0
    again = predictor.predict({"site_mm": [5, -10], "depth_mm": 2, "angle_deg": 20, "heading_deg": 45,
                               "shape": "shape-1", "softness": "S1"})  # fmt: skip
    np.testing.assert_array_equal(again.displacement, answer.displacement)
    assert {p.name for p in answer.save(tmp_path / "out").iterdir()} == {
        "displacement.csv", "prediction.json", "prediction.png",
    }  # fmt: skip
    for shown, word in ((answer, "force"), (predictor, "invariant-gnn")):
        html = shown._repr_html_()
        assert html.startswith("<table>")
        assert word in html
        assert word in repr(shown)
        assert len(repr(shown)) < 2500
    assert "data:image/png;base64" in answer._repr_html_()
    with pytest.raises(InputError, match="trained on dataset"):
        learn.load(run, dataset=write_store(tmp_path / "o.zarr", seed=4, frames=1))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_force_that_is_not_above_0_has_no_interval(
    run: Path, sign: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its interval is a factor around it: around a negative force its ends would be swapped."""
    predictor = learn.load(run)
    predictor.__dict__["intervals"] = Intervals(
        level=0.9, promised=0.9, pokes=9, scale=[0.0] * 9, factors=[1.0] * 20, force_scale=0.1, force=1.0
    )
    plain = predictor.run.model.forward
    monkeypatch.setattr(
        predictor.run.model,
        "forward",
        lambda scene, pokes: replace(found := plain(scene, pokes), force=sign * found.force.abs()),
    )
    answer = predictor.predict({"site_mm": [5, -10], "depth_mm": 2, "shape": "shape-1", "softness": "S1"})
    assert answer.radius is not None
    said = answer.as_dict()
    assert "radius_mean_mm" in said
    if sign > 0:
        low, high = answer.force_interval or (0.0, 0.0)
        assert (said["force_low_N"], said["force_high_N"]) == (low, high)
        assert 0.0 < low < answer.force < high
    else:
        assert answer.force_interval is None
        assert "force_low_N" not in said
        assert "(no interval: it is 0 N or less)" in repr(answer)


def test_an_ensemble_is_of_runs_that_differ_in_seed_alone(run: Path, tmp_path: Path) -> None:
    content = load_checkpoint(run / "best.pt")
    for key, value in {"seed": 5, "fold": 1, "batch": 7}.items():
        (tmp_path / key).mkdir()
        changed = {**content, "recipe": {**content["recipe"], key: value}}
        save_checkpoint(tmp_path / key / "best.pt", changed)
    joined = learn.load([run, tmp_path / "seed"]).run
    assert joined.members == (run, tmp_path / "seed")
    sums = [hashlib.sha256((folder / "best.pt").read_bytes()).hexdigest() for folder in joined.members]
    (tmp_path / "seed" / "best.pt").unlink()  # what a run that is still trained replaces
    assert joined.weights == tuple(sums)
    for key, value in {"fold": 1, "batch": 7}.items():
        words = f"{key}: expected runs that differ in seed alone, this one has {key} {value}"
        with pytest.raises(InputError, match=words):
            learn.load([run, tmp_path / key])


def test_the_shipped_scene_is_read() -> None:
    from learn.scene_file import load_poke

    poke = load_poke(Path(__file__).parents[2] / "datasets" / "scenes" / "poke.yaml")
    assert poke.shape == "cube-18"  # a shape of the quick recipe
    assert poke.softness == "S0.5"
