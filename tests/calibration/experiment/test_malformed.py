"""Invalid experiments are refused in one sentence with the file, the key or line, and the expectation."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import malformed_beams
import malformed_others
import malformed_tables
import pytest
import yaml
from changes import PULL, YAML
from hypothesis import given, settings
from hypothesis import strategies as st
from sample import sample

from calibration.errors import InputError
from calibration.experiment import read

CASES = {**malformed_others.CASES, **malformed_beams.CASES, **malformed_tables.CASES}


def _refusal(folder: Path) -> str:
    with pytest.raises(InputError) as caught:
        read(folder)
    return str(caught.value)


@pytest.mark.parametrize("case", CASES)
def test_malformed_folders_are_refused(case: str, tmp_path: Path) -> None:
    change, file, place, expected = CASES[case]
    made = sample()
    change(made)
    text = _refusal(made.write(tmp_path))
    assert text.startswith(f"{tmp_path / file}: {place}"), text
    assert expected in text, text
    assert "\n" not in text


@pytest.mark.parametrize(
    ("text", "place", "expected"),
    [
        ("format: 1\nname: a\nname: b\n", "line 3:", "key name stands there twice, expected it once"),
        ("format: [1\n", "line 2:", "expected valid YAML"),
        ("- 1\n", "", "expected keys and values at the top level"),
        ("format: 1\nname: &a [*a]\n", "", "expected plain YAML values"),
        ("format: 1\nname: !!python/name:os.system x\n", "line 2:", "constructor for the tag"),
        ("", "", "expected keys and values at the top level"),
    ],
)
def test_malformed_yaml_is_refused(text: str, place: str, expected: str, tmp_path: Path) -> None:
    (tmp_path / YAML).write_text(text)
    said = _refusal(tmp_path)
    assert said.startswith(f"{tmp_path / YAML}: {place}"), said
    assert expected in said
    assert "\n" not in said


ODD = [None, True, -1, 0, 1e308, 10**400, float("nan"), "", "\n", "..", "a\0.csv", "x" * 400 + ".csv"]
ODD += [[], [1], {}, {1: 2}, {"a": {"b": None}}, b"ab"]


def _places(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    keys = value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in keys:
        yield (*place, key)
        yield from _places(value[key], (*place, key))


@settings(max_examples=80, deadline=None)
@given(data=st.data())
def test_no_value_in_any_place_ends_otherwise(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """An experiment with odd values anywhere is read, or refused in one sentence of limited length."""
    folder = sample().write(tmp_path_factory.mktemp("odd"))
    whole = yaml.safe_load((folder / YAML).read_text())
    *path, last = data.draw(st.sampled_from(list(_places(whole))))
    target = whole
    for step in path:
        target = target[step]
    target[last] = data.draw(st.sampled_from(ODD))
    (folder / YAML).write_text(yaml.safe_dump(whole))
    try:
        read(folder)
    except InputError as error:
        text = str(error)
        assert "expected" in text
        assert "\n" not in text
        assert len(text) < len(str(folder)) + 400


def test_a_folder_without_the_file_is_refused(tmp_path: Path) -> None:
    assert _refusal(tmp_path) == f"{tmp_path / YAML}: missing, expected it in the experiment's folder"
    assert _refusal(tmp_path / "none").endswith("expected a folder that holds experiment.yaml")


def test_links_out_of_the_folder_are_refused(tmp_path: Path) -> None:
    folder = sample().write(tmp_path / "inside")
    (folder / PULL).rename(tmp_path / "pull.csv")
    (folder / PULL).symlink_to(tmp_path / "pull.csv")
    assert "key trials[pull].record: expected a file inside the experiment's folder" in _refusal(folder)


def test_a_link_to_the_truth_is_refused(tmp_path: Path) -> None:
    folder = sample().write(tmp_path)
    (folder / PULL).rename(folder / "truth.yaml")
    (folder / PULL).symlink_to(folder / "truth.yaml")
    assert "key trials[pull].record: expected a file inside" in _refusal(folder)
