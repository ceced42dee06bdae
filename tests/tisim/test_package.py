"""The package as a whole: cost of its import, version, output of `python -m tisim`, examples."""

from __future__ import annotations

import doctest
import inspect
import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import tisim

ROOT = Path(tisim.__file__).parents[1]
HEAVY = {
    "taichi", "scipy", "trimesh", "pyvista", "meshio", "pytetwild", "matplotlib", "manifold3d", "igl",
    "loky", "cv2", "pypardiso", "cloudpickle", "threadpoolctl", "rtree", "torch", "pandas",
}  # fmt: skip


def run(*arguments: str) -> str:
    """Standard output of a Python process in the repository's root."""
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout


def loaded(statements: str) -> set[str]:
    """Heavy packages that a new process has imported after these statements."""
    text = run("-c", f"{statements}\nimport sys, json; print(json.dumps(sorted(sys.modules)))")
    return HEAVY & {name.partition(".")[0] for name in json.loads(text.splitlines()[-1])}


def test_import_brings_in_nothing_but_numpy() -> None:
    assert loaded("import tisim") == set()


def test_materials_meshes_and_checks_need_no_compiler() -> None:
    statements = """
import tisim
from tisim.problems._checks import check_scene
soft = tisim.material_from_moduli("ogden", shear_modulus=1e4, bulk_modulus=1e6)
for scene in (tisim.Beam(material=soft, length=0.05), tisim.Poke(material=soft), tisim.Coupon(material=soft)):
    check_scene(0, scene)
tisim.mesh.beam_mesh(length=0.05, section=tisim.Circle(radius=0.01))
"""
    assert loaded(statements) == set()


def test_version_is_that_of_the_project() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    if "version" in project:
        assert tisim.__version__ == project["version"]
    assert run("-m", "tisim", "--version") == f"tisim {tisim.__version__}\n"


def test_the_module_prints_what_the_package_offers() -> None:
    text = run("-m", "tisim")
    assert text.startswith(f"tisim {tisim.__version__}")
    for name in ("Beam, Poke, Coupon, Press", "neo-hookean", "sphere", "factory.build"):
        assert name in text


@pytest.mark.parametrize("module", ["tisim.laws", "tisim.inclusions", "tisim.problems"])
def test_examples_of_adding_run(module: str) -> None:
    """In a separate process, since the examples register laws, shapes and scenes."""
    test = f"import doctest, {module}; raise SystemExit(doctest.testmod({module}).failed)"
    run("-c", test)


def test_docstring_of_the_package_runs() -> None:
    assert doctest.testmod(tisim).failed == 0


def test_every_public_name_has_a_docstring() -> None:
    modules = (tisim, tisim.laws, tisim.mesh, tisim.inclusions, tisim.problems)
    missing = {
        f"{module.__name__}.{name}"
        for module in modules
        for name in module.__all__
        if inspect.isroutine(getattr(module, name)) or inspect.isclass(getattr(module, name))
        if not inspect.getdoc(getattr(module, name))
    }
    assert not missing
