"""Laws registered from a file, a script and a prompt, in this and in other processes."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from other_process import python

import tisim
from tisim import _extensions, laws

GENT = '''
"""Gent's law (Rubber Chem. Technol. 69, 1996), isochoric plus volumetric: a law of somebody else's."""

from __future__ import annotations

import numpy as np

from tisim.laws import Law, Moduli, by_invariants, first_isochoric, register, ti


@ti.func
def logarithm(x):
    return ti.log(x)


@ti.func
def energy(I1, I2, J, prm: ti.template()):
    i1, slope = first_isochoric(I1, J)
    room = 1.0 - (i1 - 3.0) / prm[1]
    d = 0.5 * prm[0] / room
    return by_invariants(-0.5 * prm[0] * prm[1] * logarithm(room), d, d / (prm[1] * room), i1, slope, J)


LAW = register(
    Law(
        name="gent",
        title="Gent",
        parameters={"mu": ("Pa", "scalar"), "limit": ("-", "scalar"), "bulk": ("Pa", "scalar")},
        family="invariant",
        theta="log",
        energy=energy,
        pack=lambda p: np.array([p["mu"], p["limit"]]),
        kappa=lambda p: p["bulk"],
        moduli=lambda p: Moduli(shear_modulus=p["mu"], bulk_modulus=p["bulk"]),
        from_moduli=lambda shear, bulk: {"mu": shear, "limit": 30.0, "bulk": bulk},
        fault=lambda p: "" if p["limit"] > 0.0 else "parameter limit [-]: expected a number above 0",
    )
)
'''
CELL = GENT.replace("from __future__ import annotations", "").replace('name="gent"', 'name="gent-cell"')
MAIN = f"""
import linecache
import sys

import numpy as np
import tisim

CELL = {CELL.replace("prm: ti.template()", "prm: 'ti.template()'")!r}
NAME = __file__ + " cell"
linecache.cache[NAME] = (1, None, CELL.splitlines(True), NAME)

if __name__ == "__main__":
    import my_gent

    exec(compile(CELL, NAME, "exec"), globals())
    assert tisim.laws.names()[-2:] == ("gent", "gent-cell")
    # a chain of scenes of each law: each of the two processes compiles the kernels of one
    scenes = []
    for law, count in (("gent", 4), ("gent-cell", 5)):
        soft = tisim.material_from_moduli(law, shear_modulus=2e4, bulk_modulus=2e8)
        scenes += [tisim.Coupon(material=soft, stretches=(1.5, 3.0 - 0.01 * k)) for k in range(count)]
    for found in tisim.simulate(scenes, workers=2):
        s = found.load
        exact = 2e4 * (s - s**-2) * 30.0 / (30.0 - (s**2 + 2.0 / s - 3.0))  # incompressible
        assert found.ok and np.allclose(found.nominal_stress, exact, rtol=1e-3)
    print("taichi" not in sys.modules)
"""


@pytest.fixture
def gent(tmp_path: Path) -> Iterator[ModuleType]:
    (tmp_path / "my_gent.py").write_text(GENT)
    sys.path.insert(0, str(tmp_path))
    try:
        import my_gent

        yield my_gent
    finally:
        laws.unregister("gent")
        sys.path.remove(str(tmp_path))
        sys.modules.pop("my_gent", None)


@pytest.mark.parametrize("law", laws.all_names())
def test_every_law_is_sound(law: str) -> None:
    report = laws.check_law(law)
    assert report.ok, str(report)


def test_a_law_from_a_file_is_one_of_the_laws(gent: ModuleType) -> None:
    assert laws.names()[-1] == laws.all_names()[-1] == "gent"
    assert laws.get("gent") is gent.LAW
    report = laws.check_law("gent")
    assert report.ok, str(report)


def test_other_processes_know_added_laws(tmp_path: Path) -> None:
    """Holds for a law imported from a file, and for one defined in a notebook cell without a source file.

    Coupons of both have the closed form, and this process loads no Taichi: it leaves them to the others.
    """
    (tmp_path / "my_gent.py").write_text(GENT)
    (tmp_path / "run.py").write_text(MAIN)
    assert python(tmp_path, str(tmp_path / "run.py")) == "True"


def test_a_law_registered_anew_takes_the_place_of_the_old(gent: ModuleType) -> None:
    """A second registration, as in a notebook, does not use any kernel of the first one."""
    stress = laws.evaluate("gent", {"mu": 1.0, "limit": 30.0, "bulk": 10.0}, np.diag([2.0, 1.0, 1.0])[None])[
        1
    ]
    laws.register(replace(gent.LAW, energy=laws.get("yeoh").energy, pack=_as_yeoh))
    other = laws.evaluate("gent", {"mu": 1.0, "limit": 30.0, "bulk": 10.0}, np.diag([2.0, 1.0, 1.0])[None])[1]
    assert np.abs(stress - other).max() > 1e-3


def _as_yeoh(p: laws.Parameters) -> np.ndarray:
    return np.array([p["mu"], 0.5])


def test_what_is_no_law_is_refused(gent: ModuleType) -> None:
    with pytest.raises(ValueError, match="'ogden' is a law of tisim's own"):
        laws.register(replace(gent.LAW, name="ogden"))
    with pytest.raises(ValueError, match="expected a name of lower-case letters"):
        laws.register(replace(gent.LAW, name="My law"))
    with pytest.raises(TypeError, match="expected a Law, got str"):
        laws.register("gent")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="has other moduli"):
        laws.register(
            replace(gent.LAW, moduli=lambda p: laws.Moduli(shear_modulus=1.0, bulk_modulus=p["bulk"]))
        )


def test_an_unsound_law_is_found(gent: ModuleType) -> None:
    """With a wrong shear modulus passed to the kernel the stress at rest is right, but the moduli are not."""
    wrong = replace(gent.LAW, pack=lambda p: np.array([1.1 * p["mu"], p["limit"]]))
    report = laws.check_law(wrong)
    assert not report.ok
    assert any("tangent at rest has the stated moduli" in fault for fault in report.faults)
    assert "NOT sound" in str(report)


def test_nothing_of_taichi_is_imported_before_a_law_is_evaluated(tmp_path: Path) -> None:
    (tmp_path / "my_gent.py").write_text(GENT)
    script = "import sys, tisim, my_gent; print('taichi' in sys.modules)"
    assert python(tmp_path, "-c", script) == "False"


def test_commands_know_the_laws_of_files_that_the_environment_names(tmp_path: Path) -> None:
    file = tmp_path / "my_gent.py"
    file.write_text(GENT)
    environment = {**os.environ, "TISIM_EXTENSIONS": str(file)}
    root = Path(tisim.__file__).parents[1]

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *arguments],
            env=environment,
            cwd=root,
            capture_output=True,
            text=True,
            check=False,
        )

    assert f"{laws.all_names()[-1]}, gent" in run("-m", "tisim").stdout
    # a chain of each law: one process needs the file
    script = (
        "import tisim; laws = ['gent'] * 4 + ['neo-hookean'] * 5;"
        "some = [tisim.material_from_moduli(law, shear_modulus=1e4, bulk_modulus=1e6) for law in laws];"
        "scenes = [tisim.Coupon(material=m, stretches=(2.0 + 0.01 * k,)) for k, m in enumerate(some)];"
        "print({r.ok for r in tisim.simulate(scenes, workers=2)})"
    )
    done = run("-c", script)
    assert done.stdout.strip() == "{True}", done.stderr
    environment["TISIM_EXTENSIONS"] = str(tmp_path / "nowhere.py")
    done = run("-m", "tisim")
    assert done.returncode == 2
    assert done.stderr.startswith("error: TISIM_EXTENSIONS: ")
    assert done.stderr.endswith("expected a Python file that exists\n")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("names", "text", "words"),
    [
        (
            ["a/own_law_1.py", "b/own_law_1.py"],
            "x = 1\n",
            "another module is called own_law_1: expected",
        ),
        (["numbers.py"], "x = 1\n", "another module is called numbers"),
        (["own_law_2.py"], "x = 1\ny = x + z\n", "NameError: name 'z' is not defined (line 2)"),
    ],
)
def test_extensions_that_would_not_be_there_are_refused(
    names: list[str], text: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paths = [tmp_path / name for name in names]
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    monkeypatch.setenv("TISIM_EXTENSIONS", os.pathsep.join(map(str, paths)))
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)
    with pytest.raises(ImportError) as caught:
        _extensions.load()
    sys.modules.pop("own_law_1", None)
    assert str(caught.value).startswith(f"TISIM_EXTENSIONS: {paths[-1]}: ")
    assert words in str(caught.value)
