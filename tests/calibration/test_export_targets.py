"""Files written for each program, statements of the losses, and unusable input."""

from __future__ import annotations

import doctest
import json
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

import calibration.export as export
import tisim
from calibration.export import Job, Prediction, Target, Written, _export
from calibration.export._scene import Reference
from calibration.export.command import TARGETS, app

ROOT = Path(__file__).resolve().parents[2]
CARDS = ROOT / "datasets" / "materials"
CLEAN = ROOT / "datasets" / "measured" / "bench" / "clean"
SHORT = "S0-cantilever-050"
CCX = shutil.which("ccx")
PROGRAMS = ("sofa", "febio", "abaqus", "calculix", "mujoco", "newton")


def card(folder: Path, **changes: object) -> Path:
    """The paper's S0 with other keys."""
    content = yaml.safe_load((CARDS / "S0.yaml").read_text(encoding="utf-8")) | changes
    path = folder / "S0.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path


def text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("program", PROGRAMS)
def test_every_law_of_a_card_is_written_or_refused(program: str, tmp_path: Path) -> None:
    """Without a scene: the material, and a README with the losses."""
    for law in ("neo-hookean", "ogden"):
        done = export.export_card(
            CARDS / "S0.yaml", to=program, out=tmp_path / law, law=law, scene=False, most_loss=1.0
        )
        form = done.job.form
        assert form.young == pytest.approx(9 * 606800.0 * 30341.0 / (3 * 606800.0 + 30341.0), rel=2e-4)
        readme = text(done.folder / "README.md")
        for sentence in done.lost:
            assert sentence in readme
        if done.job.conversion.how == "same":
            assert not done.lost
        else:
            assert any("differs" in s and "%" in s for s in done.lost)


def test_a_beam_in_calculix_form_runs_and_is_read_again(tmp_path: Path) -> None:
    """CalculiX, if installed, gives the stated beam; tisim.read reads mesh and sets; losses are printed."""
    words = [str(CARDS / "S0.yaml"), "--to", "calculix", "--out", str(tmp_path / "out")]
    words += ["--refinement", "0.75", "--experiment", str(CLEAN), "--trial", SHORT]
    done = CliRunner().invoke(app, [*words, *(["--check"] if CCX else [])])
    assert done.exit_code == 0, done.output
    if CCX:
        found = re.search(
            r"Run: the beam's end is ([0-9.]+) % from what was expected, as stated", done.output
        )
        assert found is not None
        assert float(found[1]) < 3.5
    assert "volumetric part, which is K/2 (J - 1)^2 there" in done.output
    assert f"trial {SHORT} of experiment 'clean'" in done.output
    mesh = tisim.read(tmp_path / "out" / "beam.inp")
    assert (mesh.kind, sorted(mesh.node_sets)) == ("tet10", ["beam", "clamp", "end", "nall"])
    assert np.ptp(mesh.nodes[:, 0]) == pytest.approx(0.05)
    assert np.all(mesh.nodes[mesh.node_sets["clamp"], 0] == 0.0)
    assert np.all(mesh.nodes[mesh.node_sets["end"], 0] == 0.05)
    deck = text(tmp_path / "out" / "beam.inp")
    assert "*HYPERELASTIC, NEO HOOKE\n15170.5," in deck
    assert "BEAM, GRAV, 9.81, 0, 0, -1" in deck
    assert (
        max(len(x.strip()) for line in deck.splitlines() for x in line.split(",") if line[:1].isdigit()) <= 20
    )


def test_linear_tetrahedra_are_told_with_their_error(tmp_path: Path) -> None:
    """Newton and SOFA: the expected beam is tisim's with their law, elements and mesh."""
    done = export.export_card(
        CARDS / "S0.yaml", to="newton", out=tmp_path / "n", experiment=CLEAN, trial=SHORT, refinement=0.4
    )
    p = done.job.prediction
    assert p is not None
    assert p.elements is not None
    assert p.elements < -0.1
    assert f"linear tetrahedra of this mesh make {-100 * p.elements:.2g} %" in text(
        tmp_path / "n" / "README.md"
    )
    values = json.loads(text(tmp_path / "n" / "material.json"))
    g = values["k_mu"]
    assert (values["k_lambda"] / (2 * (values["k_lambda"] + g)), values["density"]) == pytest.approx(
        (0.45, 1019.1)
    )
    stated = "density 1019.1 kg/m3, as experiment 'clean' states it; the card has 1000"
    assert any(stated in remark for remark in done.remarks)
    mesh = tisim.read(tmp_path / "n" / "beam.msh")
    assert done.job.scene is not None
    np.testing.assert_array_equal(mesh.elements, done.job.scene.mesh.elements)
    compile(text(tmp_path / "n" / "beam.py"), "beam.py", "exec")


def test_time_goes_to_those_who_have_it(tmp_path: Path) -> None:
    viscous = CARDS / "S1-viscous.yaml"
    part = yaml.safe_load(text(viscous))["viscosity"]
    fractions = np.array(part["fractions"])
    there = export.export_card(viscous, to="abaqus", out=tmp_path / "a", scene=False)
    assert not [s for s in there.lost if "Prony" in s]
    lines = text(tmp_path / "a" / "material.inp").splitlines()
    at = lines.index("*VISCOELASTIC, TIME=PRONY") + 1
    series = np.array([[float(x) for x in row.split(",")] for row in lines[at : at + len(fractions)]])
    np.testing.assert_allclose(series[:, 0], fractions / (1 + fractions.sum()), rtol=1e-8)
    assert any("MODULI=LONG TERM" in x for x in lines)
    six = export.export_card(viscous, to="febio", out=tmp_path / "f", scene=False)
    assert not six.lost[1:]
    outer = ET.parse(tmp_path / "f" / "material.feb").getroot().find("Material/material")
    assert outer is not None
    assert outer.get("type") == "uncoupled viscoelastic"
    inner = outer.find("elastic")
    assert inner is not None
    assert inner.get("type") == "Mooney-Rivlin"  # FEBio's viscoelastic part is uncoupled
    total = sum(float(outer.findtext(f"g{k}", "nan")) for k in range(1, 7))
    assert total == pytest.approx(fractions.sum(), rel=0.02)
    none = export.export_card(viscous, to="calculix", out=tmp_path / "c", scene=False)
    assert any(
        "Prony series is left out" in s and f"{1 + fractions.sum():.3g} at once" in s for s in none.lost
    )


def test_softening_and_fibres_go_to_those_who_have_them(tmp_path: Path) -> None:
    path = card(
        tmp_path,
        softening={"kind": "ogden-roxburgh", "r": 2.0, "m_J_per_m3": 500.0},
        fibres={"kind": "holzapfel-gasser-ogden", "direction": [0, 3, 4], "k1_Pa": 5000.0, "k2": 0.5},
    )
    export.export_card(path, to="abaqus", out=tmp_path / "a", scene=False)
    deck = text(tmp_path / "a" / "material.inp")
    assert "*MULLINS EFFECT\n2, 500, 0" in deck
    assert "*ANISOTROPIC HYPERELASTIC, HOLZAPFEL, LOCAL DIRECTIONS=1\n15170.5," in deck
    assert "LOCAL DIRECTIONS=1\n0, 0.6, 0.8," in deck  # orientation of the section
    export.export_card(path, to="calculix", out=tmp_path / "c", scene=False)
    assert "ELASTIC_FIBER" in text(tmp_path / "c" / "material.inp")
    done = export.export_card(path, to="febio", out=tmp_path / "f", scene=False)
    root = ET.parse(tmp_path / "f" / "material.feb").getroot()
    assert root.findtext(".//solid[@type='fiber-exp-pow-uncoupled']/fiber") == "0,0.6,0.8"
    (lost,) = [s for s in done.lost if "softening" in s]
    assert "Unloading from a stretch of 1.25" in lost
    gone = export.export_card(path, to="sofa", out=tmp_path / "s", scene=False)
    assert any("fibres are left out: along them" in s for s in gone.lost)


def test_abaqus_fibres_without_stiffening_and_their_volumetric_part(tmp_path: Path) -> None:
    """A diagnosis' fibres have k2 = 0, by which HOLZAPFEL divides; it has a volumetric part of its own."""
    fibres = {"kind": "holzapfel-gasser-ogden", "direction": [1, 0, 0], "k1_Pa": 5000.0, "k2": 0.0}
    done = export.export_card(card(tmp_path, fibres=fibres), to="abaqus", out=tmp_path / "a", scene=False)
    deck = text(tmp_path / "a" / "material.inp").splitlines()
    at = next(k for k, line in enumerate(deck) if line.startswith("*ANISOTROPIC"))
    assert [float(x) for x in deck[at + 1].split(",")[2:5]] == [5000.0, 1e-6, 0.0]
    assert any("K/2 ((J^2 - 1)/2 - ln J)" in s for s in done.lost)


@pytest.mark.parametrize("program", ["febio", "abaqus", "sofa", "mujoco"])
def test_scenes_hold_the_beam(program: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The files are complete, have the beam's weight, and clamp its end; tisim's solution is not computed."""
    still = Reference(moved=np.array([0.0, 0.0, -1e-3]), low=0.95, high=1.05)
    told = Prediction(reference=still.moved, expected=None, error=np.nan, low=0.95, high=1.05)
    monkeypatch.setattr(_export, "solve", lambda _: still)
    monkeypatch.setattr(_export, "predict", lambda *_, **__: told)
    done = export.export_card(
        CARDS / "S0.yaml",
        to=program,
        out=tmp_path,
        experiment=CLEAN,
        trial=SHORT,
        refinement=0.4,
        overwrite=True,
    )
    scene = done.job.scene
    assert scene is not None
    assert done.files[0].name == "README.md"
    if program == "febio":
        root = ET.parse(tmp_path / "beam.feb").getroot()
        assert len(root.findall("Mesh/Nodes/node")) == scene.mesh.n_nodes
        assert root.findtext("Loads/body_load/force") == "0,0,9.81"  # opposite to its vector
        held = root.findtext("Mesh/NodeSet[@name='clamp']", "")
        assert [int(n) - 1 for n in held.split(",")] == scene.held.tolist()
    elif program == "abaqus":
        assert "TYPE=C3D10H" in text(tmp_path / "beam.inp")
        assert tisim.read(tmp_path / "beam.inp").n_elements == scene.mesh.n_elements
    elif program == "sofa":
        code = text(tmp_path / "beam.py")
        compile(code, "beam.py", "exec")
        assert 'materialName="NeoHookean"' in code
        assert f"CLAMPED = {[int(n) for n in scene.held]}" in code
    else:
        root = ET.parse(tmp_path / "beam.xml").getroot()
        masses = [float(e.get("mass", "nan")) for e in root.iter("inertial")]
        assert len(masses) == scene.mesh.n_nodes - len(scene.held)
        assert sum(masses) == pytest.approx(scene.mass.sum() - scene.mass[scene.held].sum(), rel=1e-6)
        flex = root.find("deformable/flex")
        assert flex is not None
        assert flex.get("body", "").split().count("world") == len(scene.held)


@pytest.mark.slow
@pytest.mark.skipif(CCX is None, reason="needs ccx (apt-get install calculix-ccx)")
@pytest.mark.parametrize("law", ["ogden", "arruda-boyce"])
def test_calculix_gives_the_papers_beam(law: str, tmp_path: Path) -> None:
    done = export.export_card(CARDS / "S1.yaml", to="calculix", out=tmp_path / "out", law=law, check=True)
    assert done.checked is not None
    assert done.within, done.checked
    assert done.checked.from_reference < 0.02


@pytest.mark.slow
def test_mujoco_gives_the_stated_beam(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    done = export.export_card(
        CARDS / "S0.yaml", to="mujoco", out=tmp_path / "out", experiment=CLEAN, trial=SHORT, check=True
    )
    assert done.checked is not None
    assert done.checked.from_expected < 0.005  # St Venant-Kirchhoff on the same mesh in both
    assert done.within


# -- a user's own program --


@pytest.fixture
def made_up() -> Iterator[str]:
    def write(job: Job, folder: Path) -> Written:
        path = folder / "soft.txt"
        path.write_text(f"{job.name} {job.form.mu[0]:.6g} {job.form.lam:.6g} {sorted(job.keeps)}")
        return Written(files={path: "the material"}, remarks=("made up",))

    target = Target(
        name="made-up",
        title="Made up 1",
        writes=lambda form, _: form if form.kind == "neo-hookean" else None,
        keeps=lambda material, _: {"viscosity"} if material.viscosity is not None else set(),
        write=write,
    )
    yield export.register(target).name
    export.unregister("made-up")


def test_a_program_is_one_registration(made_up: str, tmp_path: Path) -> None:
    words = [str(CARDS / "S1-viscous.yaml"), "--to", made_up, "--out", str(tmp_path / "out"), "--no-scene"]
    done = CliRunner().invoke(app, [*words, "--law", "arruda-boyce"])
    assert done.exit_code == 0, done.output
    assert text(tmp_path / "out" / "soft.txt").endswith("['viscosity']")
    assert "There is no arruda-boyce there: neo-Hookean, coupled stands for it" in done.output
    assert "- Made up." in text(tmp_path / "out" / "README.md")
    assert export.names()[-1] == "made-up"


def test_registrations_that_cannot_be() -> None:
    with pytest.raises(TypeError, match="expected a Target, got str"):
        export.register("sofa")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="one of calibration's own"):
        export.register(export.get("sofa"))


def test_the_recipe_for_adding_a_program_runs() -> None:
    failed, tried = doctest.testmod(export)
    export.unregister("my-program")
    assert tried > 4
    assert not failed


# -- the command --


def test_the_command_starts_light_and_names_all_programs() -> None:
    assert tuple(TARGETS.split(", ")) == export.names() == PROGRAMS
    code = (
        "import sys; from typer.testing import CliRunner; from calibration.export import app\n"
        "done = CliRunner().invoke(app, ['--help']); assert done.exit_code == 0, done.output\n"
        "print([m for m in ('numpy', 'scipy', 'matplotlib', 'taichi', 'pydantic') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert "taichi" not in done.stdout
    assert "scipy" not in done.stdout


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--to", "ansys"], "error: --to ansys: expected one of sofa, febio, abaqus, calculix, mujoco,"),
        (["--law", "yeoh"], "error: --law yeoh: expected one of the card's: st-venant-kirchhoff"),
        (["--trial", "A1"], "error: --trial A1: expected --experiment beside it"),
        (["--experiment", str(CLEAN), "--trial", "A1"], "error: --trial A1: expected a beam of that"),
        (["--no-scene", "--trial", "A1"], "error: --trial A1: expected a scene, which --no-scene leaves out"),
        (["--experiment", "/nowhere"], "error: /nowhere"),
        (["--refinement", "9"], "error: --refinement 9: expected a factor of 0.3 to 4"),
        (["--most-loss", "0"], "error: --most-loss 0: expected a fraction above 0"),
        (["--to", "sofa", "--check"], "error: --check: expected a scene for one of calculix, mujoco, newton"),
    ],
)  # fmt: skip
def test_bad_input_is_one_sentence(words: list[str], sentence: str, tmp_path: Path) -> None:
    first = [str(CARDS / "S0.yaml"), *([] if "--to" in words else ["--to", "calculix"])]
    done = CliRunner().invoke(app, [*first, "--out", str(tmp_path / "out"), *words])
    assert done.exit_code == 2, done.output
    (line,) = [x for x in done.stderr.splitlines() if x.strip()]
    assert line.startswith(sentence)
    assert not (tmp_path / "out").exists()


def test_files_that_are_no_cards_or_no_empty_folders(tmp_path: Path) -> None:
    broken = card(tmp_path, viscosity={"kind": "prony", "fractions": [0.1], "times_s": [-1.0]})
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine")
    for path, out, sentence in (
        (tmp_path / "none.yaml", "o", f"error: {tmp_path / 'none.yaml'}: expected a material card"),
        (CLEAN / "experiment.yaml", "o", f"error: {CLEAN / 'experiment.yaml'}: expected a material card"),
        (broken, "o", f"error: {broken}: key viscosity.times_s: expected"),
        (CARDS / "S0.yaml", "full", f"error: --out {tmp_path / 'full'}: expected an empty folder"),
        (
            CARDS / "S0.yaml",
            "S0.yaml",
            f"error: --out {tmp_path / 'S0.yaml'}: expected a folder, found a file",
        ),
    ):
        words = [str(path), "--to", "febio", "--out", str(tmp_path / out), "--no-scene"]
        done = CliRunner().invoke(app, words)
        assert done.exit_code == 2, done.output
        assert " ".join(done.stderr.split()).startswith(sentence)
    assert [p.name for p in (tmp_path / "full").iterdir()] == ["mine.txt"]


def test_the_card_says_where_it_comes_from(tmp_path: Path) -> None:
    provenance = "Calibrated on experiment 'monday' (sha256 0123456789abcdef) by calibration.fit."
    effect = {
        "effect": "residual-curvature", "applies_to": "shape",
        "parameters": {"per_m": {"value": 0.8, "sd": 0.1}},
    }  # fmt: skip
    path = card(tmp_path, provenance=provenance, effects=[effect])
    done = export.export_card(path, to="sofa", out=tmp_path / "a", scene=False)
    assert any("experiment 'monday': give --experiment FOLDER" in r for r in done.remarks)
    assert any("not exported: residual-curvature (per_m 0.8 +- 0.1)" in r for r in done.remarks)
    other = export.export_card(path, to="sofa", out=tmp_path / "b", scene=False, experiment=CLEAN)
    assert any("0123456789abcdef" in r and "the scene is of 'clean'" in r for r in other.remarks)
