"""`calibration.fit`, `diagnose`, `reconstruct` and `read_experiment` as used in a notebook."""

from __future__ import annotations

import doctest
import logging
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from _folders import coupon_entry, write_experiment

import calibration
from calibration.errors import InputError, OptionError
from calibration.progress import FitProgress, Progress
from calibration.results import DiagnosisResult, Fits, PredictionResult, Reconstruction


def strip(folder: Path, *, shear_kPa: float = 30.0) -> Path:
    """Experiment with an incompressible neo-Hookean strip stretched to twice its length."""
    stretch = np.linspace(1.05, 2.0, 20)
    stress = shear_kPa * (stretch - stretch**-2)
    return write_experiment(
        folder,
        [coupon_entry("pull", "pull.csv", material="rubber")],
        tables={"pull.csv": {"stretch": stretch, "nominal_stress_kPa": stress}},
        name="made strip",
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return strip(tmp_path_factory.mktemp("interface") / "strip")


@pytest.fixture(scope="module")
def fits(folder: Path) -> Fits:
    return calibration.fit(folder, model="neo-hookean", workers=1, generations=20)


def test_the_documented_example(folder: Path) -> None:
    import calibration.api

    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    finder = doctest.DocTestFinder(recurse=False)
    (example,) = finder.find(calibration.api, "api", globs={"folder": folder})
    runner = doctest.DocTestRunner(optionflags=flags)
    lines: list[str] = []
    runner.run(example, out=lines.append)
    assert runner.summarize(verbose=False).failed == 0, "".join(lines)
    assert runner.tries >= 5


@pytest.mark.parametrize(
    "orders",
    [
        "import calibration.fit; import calibration.diagnose; import calibration",
        "from calibration import fit; import calibration.fit; import calibration.diagnose",
        "from calibration.fit import app; import calibration; calibration.fit; import calibration.table",
    ],
)
def test_functions_are_not_hidden_by_the_commands_of_their_names(orders: str) -> None:
    code = orders + (
        "\nimport calibration, types, importlib"
        "\nfor name in ('fit', 'diagnose', 'reconstruct'):"
        "\n    assert isinstance(getattr(calibration, name), types.FunctionType), name"
        "\n    assert importlib.import_module('calibration.' + name).app is not None"
        "\nfrom calibration import fit"
        "\nassert fit is calibration.fit and callable(fit)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_an_experiment_is_fitted_as_it_is_given(tmp_path: Path) -> None:
    """Of two strips of 30 and 60 kPa one is left out; a fit of both is not taken for it."""
    stretch = np.linspace(1.05, 2.0, 20)
    shape = stretch - stretch**-2
    whole = calibration.read_experiment(
        write_experiment(
            tmp_path / "two",
            [
                coupon_entry("soft", "soft.csv", material="rubber"),
                coupon_entry("hard", "hard.csv", material="rubber"),
            ],
            tables={
                "soft.csv": {"stretch": stretch, "nominal_stress_kPa": 30.0 * shape},
                "hard.csv": {"stretch": stretch, "nominal_stress_kPa": 60.0 * shape},
            },
        )
    )
    options = {"model": "neo-hookean", "out": tmp_path / "out", "generations": 20, "held_out": False}
    alone = replace(whole, trials=tuple(t for t in whole.trials if t.id == "soft"))
    for workers in (1, 2):
        found = calibration.fit(alone, **options, workers=workers, overwrite=True)[0]
        assert found.points == 20
        assert found.shear_modulus == pytest.approx(30e3, rel=0.01)
    with pytest.raises(InputError, match="made with another trials; expected the same to go on"):
        calibration.fit(whole, **options, workers=1)
    assert pickle.loads(pickle.dumps(whole)) == whole or repr(pickle.loads(pickle.dumps(whole))) == repr(
        whole
    )


def test_fits_print_themselves(fits: Fits) -> None:
    text, page = repr(fits), fits._repr_html_()
    assert "rubber: shear modulus 30.0" in text
    assert "Calibration(rubber, neo-hookean: converged, G 30" in text
    assert "<td>neo-hookean</td>" in page
    assert len(text) < 1000
    assert "made strip" in repr(fits.experiment)
    assert "<td>pull</td>" in fits.experiment._repr_html_()


def test_fits_are_a_sequence_by_material(fits: Fits) -> None:
    assert [r.label for r in fits] == ["neo-hookean"]
    assert fits[0] is fits.best("rubber")
    assert fits.converged
    assert fits.folder is None
    with pytest.raises(InputError, match="material chalk: expected a finished fit"):
        fits.best("chalk")


def test_fits_write_cards_and_a_page(fits: Fits, tmp_path: Path) -> None:
    (card,) = fits.write_cards(tmp_path / "cards")
    assert card.name == "rubber.yaml"
    assert fits.write_report(tmp_path / "page").read_text().count("<h2>rubber</h2>") == 1


def test_a_card_of_an_earlier_run_is_not_taken_for_a_fit_that_has_none(
    fits: Fits, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """The function said nothing, and the folder looked as after a fit that had ended well."""
    (card,) = fits.write_cards(tmp_path)
    before = card.read_bytes()
    assert not caplog.records
    lost = replace(fits[0], status="no equilibrium", parameters={}, estimates=())
    unusable = Fits((lost,), fits.experiment)
    assert unusable.write_cards(tmp_path) == []
    assert caplog.messages == [
        f"rubber: no card, since no law has a finished fit; {card} is an earlier run's"
    ]
    assert card.read_bytes() == before
    assert unusable.write_cards(tmp_path / "new") == []
    assert caplog.messages[1:] == ["rubber: no card, since no law has a finished fit"]


def test_progress_is_one_callback(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    seen: list[Progress] = []
    with caplog.at_level(logging.INFO, logger="calibration"):
        found = calibration.fit(
            folder, model="neo-hookean", workers=1, generations=3, on_progress=seen.append
        )
    assert all(isinstance(p, FitProgress) for p in seen)
    assert (seen[0].done, seen[-1].done, seen[-1].total) == (0, 1, 1)
    assert "generation" in str(seen[-2])
    assert repr(found[0]) in caplog.text


@pytest.mark.parametrize(
    ("wish", "words"),
    [
        ({"seed": -1}, "seed -1: expected 0 or more"),
        ({"seed": 2**33}, "seed 8589934592: expected less than"),
        ({"workers": 0}, "workers 0: expected 1 or more"),
        ({"terms": 7}, "terms 7: expected 1 to 3"),
        ({"generations": 0}, "generations 0: expected 1 or more"),
        ({"model": "hooke"}, "model hooke: expected all or some of"),
        ({"model": []}, "model: expected at least one law"),
        ({"materials": ["chalk"]}, "material chalk: expected some of rubber"),
        ({"materials": "rubber, chalk"}, "material chalk: expected some of rubber"),
        ({"rig": "none.yaml"}, "none.yaml: the rig file cannot be read: No such file"),
        ({"objective": "guess"}, "objective guess: expected likelihood or dice"),
    ],
)
def test_wishes_that_cannot_be_met(folder: Path, tmp_path: Path, wish: dict[str, object], words: str) -> None:
    out = tmp_path / "out"
    with pytest.raises(InputError, match=words.replace("(", r"\(")):
        calibration.fit(folder, out=out, **wish)  # type: ignore[arg-type]
    assert not out.exists()


def test_options_of_a_diagnosis_are_checked(folder: Path) -> None:
    with pytest.raises(OptionError, match="seed -3"):
        calibration.diagnose(folder, seed=-3)
    with pytest.raises(InputError, match="nonsense"):
        calibration.diagnose(folder, domain="nonsense")


def test_a_single_name_is_one_name(folder: Path) -> None:
    """Not one of each letter."""
    with pytest.raises(InputError, match="nonsense"):
        calibration.diagnose(folder, without="nonsense", workers=1)
    with pytest.raises(InputError, match="extend viscosity: expected without cards"):
        calibration.predict(folder, folder, extend="viscosity")


def test_a_diagnosis_prints_itself(folder: Path) -> None:
    class Stub:
        next_experiment = "pull it <slowly>"
        implausible = ("gel: a shear modulus <of glass>",)

        def sentence(self) -> str:
            return "Found: the material <creeps> (creep)."

        def causes(self) -> list[dict[str, object]]:
            return [{"effect": "creep", "scope": "all", "parameters": {"ratio": {"value": 0.25, "sd": 0.01}}}]

    result = DiagnosisResult(Stub(), calibration.read_experiment(folder), None)  # type: ignore[arg-type]
    assert repr(result).splitlines()[0] == "Found: the material <creeps> (creep)."
    assert "creep, all, ratio, 0.25 ± 0.01" in repr(result)
    assert "&lt;creeps&gt;" in result._repr_html_()
    assert "&lt;slowly&gt;" in result._repr_html_()
    assert "gel: a shear modulus <of glass>" in repr(result).splitlines()
    assert "<p>gel: a shear modulus &lt;of glass&gt;</p>" in result._repr_html_()


@pytest.mark.parametrize(
    ("page", "kind", "file"),
    [
        ("calibration.diagnosis.report.write_report", "diagnosis", "diagnosis.json"),
        ("calibration.prediction.page.write_page", "prediction", "prediction.json"),
    ],
)
def test_a_folder_that_was_written_in_part_is_not_complete(
    page: str, kind: str, file: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An earlier result's file stood beside the page of a later one that was stopped."""

    def full(*_: object, **__: object) -> None:
        raise OSError("no space is left")

    monkeypatch.setattr(page, full)
    (tmp_path / file).write_text("{}", encoding="utf-8")
    results = {
        "diagnosis": DiagnosisResult(None, calibration.read_experiment(folder), None),  # type: ignore[arg-type]
        "prediction": PredictionResult(None),  # type: ignore[arg-type]
    }
    with pytest.raises(OSError, match="no space"):
        results[kind].write(tmp_path)  # type: ignore[attr-defined]
    assert not (tmp_path / file).exists()


def test_a_reconstruction_prints_itself(folder: Path, tmp_path: Path) -> None:
    figure = {
        "outline_sd_mm": 0.05,
        "registration_sd": {"shift_mm": 0.1, "roll_deg": 0.1, "scale": 0.001},
    }
    found = Reconstruction(
        tmp_path, calibration.read_experiment(folder), {"hang-1": figure}, {"hang-2": "blurred <edges>"}
    )
    assert "hang-1: 0.0500 mm" in repr(found)
    assert "hang-2: not used: blurred <edges>" in repr(found)
    assert "blurred &lt;edges&gt;" in found._repr_html_()


def test_a_stopped_call_goes_on(folder: Path, tmp_path: Path) -> None:
    def stop(progress: Progress) -> None:
        if "generation 2" in str(progress):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        calibration.fit(folder, model="neo-hookean", workers=1, out=tmp_path, on_progress=stop)
    kept = (tmp_path / "fits" / "rubber-neo-hookean.jsonl").read_text().splitlines()
    found = calibration.fit(folder, model="neo-hookean", workers=1, out=tmp_path)
    lines = (tmp_path / "fits" / "rubber-neo-hookean.jsonl").read_text().splitlines()
    assert lines[: len(kept)] == kept
    assert found.converged


def test_the_headline_leads_to_a_diagnosis(fits: Fits, folder: Path) -> None:
    lacking = replace(fits[0], nuisances={f"n{i}": 3.0 for i in range(10)}).assessed()
    found = Fits((lacking,), calibration.read_experiment(folder))
    (line,) = found.headlines
    assert line.startswith("rubber: no calibration: the data ask for something that neo-hookean lacks")
    assert f"python -m calibration.diagnose {folder}" in line
    assert "kPa by neo-hookean" in line
    assert not found.converged
