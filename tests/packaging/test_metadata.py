"""Licence, version and extras, as package indexes and citation readers see them."""

from __future__ import annotations

import re
import sys
import tomllib

import pytest
import yaml

import tisim
from tests.packaging.blocks import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
# modules that are imported only with an extra
OPTIONAL = {
    "trimesh",
    "rtree",
    "manifold3d",
    "pytetwild",
    "opencv-python-headless",
    "torch",
    "onnx",
    "dask",
    "xarray",
    "pooch",
    "openpyxl",
}


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[\s\[<>=;~!]", r, maxsplit=1)[0].lower() for r in requirements}


def test_licence_is_apache_2() -> None:
    assert PROJECT["project"]["license"] == "Apache-2.0" == CITATION["license"]
    assert PROJECT["project"]["license-files"] == ["LICENSE"]
    assert "Apache License\n                           Version 2.0" in (ROOT / "LICENSE").read_text(
        encoding="utf-8"
    )


def test_torch_has_the_optimiser_of_the_default_recipe() -> None:
    """`torch.optim.Muon` came with 2.9; an older torch was accepted, and training ended in a traceback."""
    (wanted,) = (r for r in PROJECT["project"]["optional-dependencies"]["learn"] if r.startswith("torch"))
    assert [int(part) for part in wanted.removeprefix("torch>=").split(".")] >= [2, 9]


def test_there_is_one_version() -> None:
    assert "version" in PROJECT["project"]["dynamic"]
    assert PROJECT["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "tisim.__version__"}
    assert CITATION["version"] == tisim.__version__
    assert f"## [{tisim.__version__}] - " in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    # a literal, so that building needs no dependency
    source = (ROOT / "tisim" / "__init__.py").read_text(encoding="utf-8")
    assert f'__version__ = "{tisim.__version__}"' in source


def test_citation_has_the_keys_that_its_format_requires() -> None:
    assert {"cff-version", "message", "title", "authors"} <= set(CITATION)
    assert CITATION["cff-version"] == "1.2.0"
    assert all(set(author) == {"name"} for author in CITATION["authors"])


def test_readme_states_the_python_versions_of_the_package() -> None:
    wanted = PROJECT["project"]["requires-python"]
    assert f"`{wanted}`" in (ROOT / "README.md").read_text(encoding="utf-8")
    low, high = (int(v) for v in re.findall(r"3\.(\d+)", wanted))
    assert low <= sys.version_info.minor < high
    classified = {c for c in PROJECT["project"]["classifiers"] if re.search(r":: 3\.\d", c)}
    assert classified == {f"Programming Language :: Python :: 3.{v}" for v in range(low, high)}


def test_what_only_an_extra_needs_is_in_the_extra() -> None:
    extras = PROJECT["project"]["optional-dependencies"]
    assert not names(PROJECT["project"]["dependencies"]) & OPTIONAL
    assert set().union(*(names(requirements) for requirements in extras.values())) >= OPTIONAL
    assert set(extras["all"]) == {"tisim[mesh,photo,learn,export,cluster,xarray,fetch,lab]"}


@pytest.mark.parametrize(
    "extra", ["mesh", "photo", "learn", "export", "cluster", "xarray", "fetch", "lab", "all", "test", "bench"]
)
def test_each_extra_is_documented(extra: str) -> None:
    assert extra in PROJECT["project"]["optional-dependencies"]
    assert f"`{extra}`" in (ROOT / "docs" / "installation.md").read_text(encoding="utf-8")
