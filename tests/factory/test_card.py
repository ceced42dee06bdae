"""The card of a dataset: its statements agree with the arrays of the store."""

from __future__ import annotations

import contextlib
import csv
import datetime
import hashlib
import io
import json
import os
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
import zarr

import factory.card
from factory import open_dataset
from factory.inspection import paper_table
from factory.plan import Plan
from factory.publishing import facts as card_facts
from factory.publishing import files as card_files
from factory.publishing.files import FILES
from factory.store.files import LEDGER, MANIFEST
from tests.factory.conftest import Builder, digest, run_app
from tests.factory.standin import site_code

OPTIONS = ("--author", "Ada & Co", "--licence", "CC-BY-4.0")


@pytest.fixture(scope="module")
def card(quick_store: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the card of the store of twelve pokes."""
    out = tmp_path_factory.mktemp("card") / "card"
    result = run_app(factory.card.app, quick_store, "--out", out, *OPTIONS)
    assert result.exit_code == 0, result.output
    return out


@pytest.fixture(scope="module")
def page(card: Path) -> str:
    return (card / "card.md").read_text(encoding="utf-8")


def _lines(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))


def test_its_files_are_all_there(card: Path, page: str) -> None:
    assert {path.name for path in card.iterdir()} == set(card_files.FILES)
    assert not list(card.parent.glob(".*")), "nothing of the making is left beside it"
    for picture in re.findall(r"!\[.*?\]\((.*?)\)", page):
        assert (card / picture).read_bytes().startswith(b"\x89PNG")


def test_the_front_matter_is_that_of_hugging_face(page: str) -> None:
    _, front, _ = page.split("---\n", 2)
    entries = yaml.safe_load(front)
    assert entries["license"] == "cc-by-4.0"
    assert entries["size_categories"] == ["n<1K"]
    assert "12 pokes" in entries["pretty_name"]
    assert {"zarr", "ogden"} <= set(entries["tags"])


def test_the_features_are_those_of_the_arrays(card: Path, quick_store: Path) -> None:
    """The features are recomputed per poke from the arrays, without the code that makes the card."""
    store = zarr.open_group(quick_store, mode="r")
    names = (store.attrs["shapes"], store.attrs["softness"])
    force = np.linalg.norm(store["rod_force"][:], axis=1)
    start, count = store["frame_start"][:], store["frame_count"][:]
    rows = _lines(card / "features.csv")
    assert [(row["shape"], row["softness"]) for row in rows] == [(s, m) for s in names[0] for m in names[1]]
    for number, row in enumerate(rows):
        those = np.flatnonzero(store["poke_geometry"][:] == number)
        frames = [slice(start[i], start[i] + count[i]) for i in those]
        deepest = np.array([store["depth"][f].max() for f in frames])
        largest = np.array([force[f].max() for f in frames])
        own = (store["solved_as"][:][those] == those).sum()
        assert (int(row["pokes"]), int(row["solves"])) == (len(those), own)
        assert int(row["frames"]) == count[those].sum()
        for name, values in (("deepest_{}_mm", 1e3 * deepest), ("largest_force_{}_N", largest)):
            stated = [float(row[name.format(part)]) for part in ("mean", "sd", "min", "max")]
            assert stated == pytest.approx(
                [values.mean(), values.std(), values.min(), values.max()], rel=1e-5
            )
        asked = store["depth_asked"][:][those]
        assert float(row["reached_fraction"]) == pytest.approx((deepest / asked).mean(), rel=1e-5)
        assert int(row["ended_not_converged"]) == len(those)
        assert sum(int(v) for key, v in row.items() if key.startswith("ended_")) == len(those)


def test_the_papers_figures_stand_beside_ours(card: Path, page: str, quick_store: Path) -> None:
    store = zarr.open_group(quick_store, mode="r")
    force = np.linalg.norm(store["rod_force"][:], axis=1)
    level = store["poke_softness"][:][store["frame_poke"][:]]
    for number, row in enumerate(_lines(card / "softness.csv")):
        paper = paper_table.PAPER["ogden"][row["softness"]]
        assert row["paper_largest_force_mean_N"] == f"{paper[1][0]:.2f}"
        assert row["paper_pokes"] == "440"
        assert float(row["frame_force_mean_N"]) == pytest.approx(force[level == number].mean(), rel=1e-5)
        mean = f"{paper[1][0]:.2f} ± {paper[1][1]:.2f}"
        assert f"| `{row['softness']}`, the paper's | 440 |" in page
        assert mean in page


def test_what_the_page_says_is_in_the_store(page: str, quick_store: Path) -> None:
    store = zarr.open_group(quick_store, mode="r")
    attributes = dict(store.attrs)
    own = int((store["solved_as"][:] == np.arange(12)).sum())
    nodes = store["mesh_nodes"][:]
    day = datetime.datetime.fromtimestamp((quick_store / MANIFEST).stat().st_mtime, tz=datetime.UTC).date()
    cores = sum(json.loads(line)["core_seconds"] for line in (quick_store / LEDGER).read_text().splitlines())
    assert own < 12
    for text in (
        attributes["uuid"],
        attributes["fingerprint"],
        f"12 simulated pokes with {store['depth'].shape[0]} equilibrium states",
        "2 shapes x 3 material levels x 2 contact points = 12 pokes",
        f"{nodes.min()} to {nodes.max()} nodes (mean {nodes.mean():.0f})",
        f"below {attributes['solver_tolerance']:g} of the load",
        f"{12 - own} of the 12 pokes differ from another only by a factor of the moduli",
        f"{own} solves took {cores:.1f} core-seconds",
        "friction coefficient of 0.6",
        f"zarr {attributes['identity']['versions']['zarr']}",
        f", mesh {attributes['identity']['mesh_layout']}, contact {attributes['identity']['contact']}.",
        "Reasons why pokes ended: not-converged 12.",
        "| checksums | 0 |",
        f"| completed | {day} |",
        f"year    = {{{day.year}}}",
        "author  = {Ada \\& Co}",
        "CC-BY-4.0. To cite",
        "studies/depth",
    ):
        assert text in page, text
    for level, entry in attributes["identity"]["materials"].items():
        # one Ogden term: G = mu alpha / 2
        shear = entry["parameters"]["mu"][0] * entry["parameters"]["alpha"][0] / 2e3
        assert re.search(rf"\| `{re.escape(level)}` \| mu = .* \| {shear:.4g} \| ", page), level


def test_its_snippet_runs_and_shows_the_deepest_poke(
    page: str, quick_store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (snippet,) = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    monkeypatch.chdir(quick_store.parent)
    shown = io.StringIO()
    with contextlib.redirect_stdout(shown):
        exec(snippet, {"__name__": "__main__"})
    deepest = zarr.open_group(quick_store, mode="r")["depth"][:].max()
    assert re.fullmatch(rf"poke \d+: {1e3 * deepest:.2f} mm, \d+\.\d+ N\n", shown.getvalue())


def test_the_sums_are_those_of_every_file(card: Path, quick_store: Path) -> None:
    lines = (card / "SHA256SUMS").read_text().splitlines()
    found = dict(reversed(line.split("  ", 1)) for line in lines)
    ledger = hashlib.sha256((quick_store / LEDGER).read_bytes()).hexdigest()
    assert found == {**digest(quick_store), LEDGER: ledger}
    assert (card / "manifest.json").read_bytes() == (quick_store / MANIFEST).read_bytes()


def test_the_date_is_the_stores(store: Path) -> None:
    """The date is that of the manifest; the fixed dates of a zip's files count as unknown, unless stated."""
    data = open_dataset(store)
    for seconds, date in ((0, None), (1.7e9, datetime.date(2023, 11, 14))):
        os.utime(store / MANIFEST, (seconds, seconds))
        assert card_facts._completed(data) == date
    assert card_facts.gather(store, date="2031-02-03").date == datetime.date(2031, 2, 3)


def test_failed_pokes_are_counted_and_end_with_1(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STANDIN_FAIL", str(site_code(plan.pokes[1].scene)))
    standin_build(plan, tmp_path / "a.zarr")
    result = run_app(factory.card.app, tmp_path / "a.zarr", "--out", tmp_path / "card")
    assert result.exit_code == 1
    assert "the card states faults (statuses: 1)" in result.stdout
    page = (tmp_path / "card" / "card.md").read_text(encoding="utf-8")
    for text in (
        "4 pokes, of which 1 failed",
        "| statuses | 1 |",
        "not-converged 3, failed 1",
        "3 solves took",
    ):
        assert text in page, text
    first, second = _lines(tmp_path / "card" / "features.csv")
    assert (first["pokes"], first["solves"], first["ended_failed"], second["ended_failed"]) == (
        "2",
        "1",
        "1",
        "0",
    )


def test_a_damaged_store_gets_no_card(store: Path, tmp_path: Path) -> None:
    file = next(path for path in sorted((store / "depth").rglob("*")) if path.is_file() and "c" in path.parts)
    file.write_bytes(file.read_bytes()[:-1] + b"?")
    result = run_app(factory.card.app, store, "--out", tmp_path / "card")
    assert result.exit_code == 2
    assert re.fullmatch(r"error: .*: the dataset is damaged \(checksums\): depth/.*manifest\n", result.stderr)
    assert not (tmp_path / "card").exists()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--licence", "my own"), "error: --licence my own: expected an SPDX identifier"),
        (("--author", "a\nb"), "error: --author: expected a name on one line"),
        (("--date", "yesterday"), "error: --date yesterday: expected a date as 2026-01-31"),
    ],
)
def test_bad_options_are_one_sentence(
    options: tuple[str, ...], sentence: str, finished_store: Path, tmp_path: Path
) -> None:
    result = run_app(factory.card.app, finished_store, "--out", tmp_path / "card", *options)
    assert result.exit_code == 2
    assert result.stderr.startswith(sentence)
    assert result.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_places_that_it_does_not_write_to(store: Path, tmp_path: Path) -> None:
    before = digest(store)
    for out, sentence in (
        (store / "card", "lies in the store"),
        (tmp_path / "file", "expected a folder, got a file"),
        (tmp_path, "is not empty: give --overwrite"),
    ):
        (tmp_path / "file").write_text("mine")
        result = run_app(factory.card.app, store, "--out", out)
        assert (result.exit_code, sentence in result.stderr) == (2, True), result.stderr
    assert digest(store) == before
    result = run_app(factory.card.app, tmp_path / "nothing.zarr", "--out", tmp_path / "card")
    assert (result.exit_code, result.stderr) == (2, f"error: {tmp_path / 'nothing.zarr'}: no such dataset\n")


def test_the_current_folder_is_a_place(
    finished_store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run_app(factory.card.app, finished_store, "--out", ".")
    assert result.exit_code in (0, 1), result.stderr  # the stand-in's numbers have faults
    assert set(FILES) <= {path.name for path in tmp_path.iterdir()}


def test_overwriting_leaves_other_files_alone(card: Path, quick_store: Path, tmp_path: Path) -> None:
    """The same store gives the same card, too."""
    out = tmp_path / "card"
    out.mkdir()
    (out / "mine.txt").write_text("mine")
    (out / "card.md").write_text("old")
    result = run_app(factory.card.app, quick_store, "--out", out, "--overwrite", *OPTIONS)
    assert result.exit_code == 0, result.output
    assert {path.name for path in out.iterdir()} == {*card_files.FILES, "mine.txt"}
    for name in card_files.FILES:
        assert (out / name).read_bytes() == (card / name).read_bytes(), name
