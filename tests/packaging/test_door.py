"""The command `tisim` offers all verbs, and imports none before it is used."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.packaging.blocks import ROOT

TABLE = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
VERBS: dict[str, str] = TABLE["entry-points"]["tisim.verbs"]
RUN = "import sys; from tisim.commands import main; main()"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the metadata and entry points of an installed tisim."""
    about = tmp_path_factory.mktemp("door") / "tisim-0.1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: tisim\nVersion: 0.1.0\n")
    lines = [f"{name} = {value}" for name, value in VERBS.items()]
    lines.append("broken = tests.packaging.no_such_module:app")
    (about / "entry_points.txt").write_text("[tisim.verbs]\n" + "\n".join(lines) + "\n")
    return about.parent


def tisim(folder: Path, *words: str, code: str = RUN, **more: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": f"{folder}{os.pathsep}{ROOT}", "COLUMNS": "200", **more}
    return subprocess.run(
        [sys.executable, "-c", code, *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_help_shows_all_verbs_with_their_purposes_and_imports_none(folder: Path) -> None:
    after = "\nfinally:\n    print(sorted({n.partition('.')[0] for n in sys.modules}))"
    code = f"import sys\nfrom tisim.commands import main\ntry:\n    main(){after}"
    shown = tisim(folder, "--help", code=code)
    assert shown.returncode == 0, shown.stderr
    lines = {line.split()[1]: line for line in shown.stdout.splitlines() if line.startswith("│")}
    for verb in VERBS:
        assert re.search(r"\w+ \w+ \w+", lines[verb].strip("│ ").removeprefix(verb)), lines[verb]
    imported = shown.stdout.splitlines()[-1]
    for package in ("factory", "calibration", "learn", "numpy", "torch", "taichi", "zarr"):
        assert f"'{package}'" not in imported


def test_help_of_every_verb_waits_for_nothing_that_computes(folder: Path) -> None:
    code = (
        "import json, sys\n"
        "from importlib import import_module\n"
        "from typer.testing import CliRunner\n"
        "for verb, value in json.loads(sys.argv[1]).items():\n"
        "    module, _, name = value.partition(':')\n"
        "    done = CliRunner().invoke(getattr(import_module(module), name), ['--help'])\n"
        "    assert done.exit_code == 0, (verb, done.output)\n"
        "    found = {n.partition('.')[0] for n in sys.modules}\n"
        "    slow = sorted(found & {'numpy', 'scipy', 'zarr', 'matplotlib', 'torch', 'taichi', 'dask'})\n"
        "    assert not slow, (verb, slow)\n"
    )
    done = tisim(folder, json.dumps(VERBS), code=code)
    assert done.returncode == 0, done.stderr


def test_every_documented_command_is_a_verb() -> None:
    page = (ROOT / "docs" / "reference" / "commands.md").read_text(encoding="utf-8")
    documented = set(re.findall(r"^\| `python -m ([\w.]+)`", page, re.MULTILINE))
    behind = {value.partition(":")[0].removesuffix(".command") for value in VERBS.values()}
    assert documented == behind
    assert TABLE["scripts"] == {"tisim": "tisim.commands:main"}


@pytest.mark.parametrize(("verb", "words"), [("build", "Build a dataset"), ("fit", "Fit constitutive laws")])
def test_a_verb_is_the_command_of_its_module(folder: Path, verb: str, words: str) -> None:
    shown = tisim(folder, verb, "--help")
    assert shown.returncode == 0, shown.stderr
    assert f"Usage: tisim {verb}" in shown.stdout
    assert words in shown.stdout


def test_bad_input_ends_as_in_the_command(folder: Path, tmp_path: Path) -> None:
    ended = tisim(folder, "build", "--model", "ogden", "--recipe", str(tmp_path / "none.yaml"))
    assert ended.returncode == 2
    assert "none.yaml" in ended.stderr


def test_a_wrong_verb_is_told_the_right_one(folder: Path) -> None:
    ended = tisim(folder, "diagnos", "experiment")
    assert ended.returncode == 2
    assert ended.stderr == "error: tisim has no verb 'diagnos': did you mean diagnose?\n"
    assert tisim(folder, "zzz").stderr == "error: tisim has no verb 'zzz': tisim --help shows all\n"


def test_version_and_completion(folder: Path) -> None:
    assert re.fullmatch(r"tisim \S+\n", tisim(folder, "--version").stdout)
    bash = {"_TISIM_COMPLETE": "complete_bash", "COMP_WORDS": "tisim tr", "COMP_CWORD": "1"}
    assert "train" in tisim(folder, **bash).stdout.split()
    options = {"_TISIM_COMPLETE": "complete_bash", "COMP_WORDS": "tisim fit --wor", "COMP_CWORD": "2"}
    assert "--workers" in tisim(folder, **options).stdout
