"""Precompilation of all kernels of a material, which the next process finds on disk."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tisim import laws, precompile
from tisim.discretisation.packed import features_of


def compiled(kernel: Any) -> bool:
    return bool(kernel._primal.compiled_kernels)


@pytest.mark.parametrize("name", ["neo-hookean", "neo-hookean+prony"])
def test_each_kernel_of_a_material_is_compiled(name: str) -> None:
    from tisim.kernels.elements import element_kernels, evaluation_kernel
    from tisim.kernels.leapfrog import leapfrog_kernel
    from tisim.kernels.points import isochoric_kernels

    made = precompile.material(name)
    law, features = laws.get(made.law), features_of(made)
    precompile._compile(name)
    kernels = [*element_kernels(law, features=features), evaluation_kernel(law, features)]
    kernels += isochoric_kernels(law, features) if features.state_size else [leapfrog_kernel(law, features)]
    assert all(map(compiled, kernels))


@pytest.mark.parametrize("name", ["rubber", "ogden+prony+rust", "ogden+", ""])
def test_an_unknown_law_or_part_is_one_sentence(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert precompile.main([name]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"{name}: expected ")
    assert error.count("\n") == 1


def test_no_workers_are_one_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    assert precompile.main(["ogden", "--workers", "0"]) == 2
    assert capsys.readouterr().err == "--workers: expected 1 or more, got 0\n"


@pytest.mark.slow
def test_the_next_process_finds_them_on_disk(tmp_path: Path) -> None:
    place = {**os.environ, "TI_OFFLINE_CACHE_FILE_PATH": str(tmp_path)}
    command = [sys.executable, "-m", "tisim.precompile", "neo-hookean"]
    subprocess.run(command, env=place, check=True)
    kept = {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*.tic")}
    assert kept
    subprocess.run(command, env=place, check=True)
    assert {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*.tic")} == kept
