"""Pages without beams, results or error bars, and pages of failed fits."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from html_page import Page
from report_cases import beam_folder, calibration, coupon_folder, estimate, failed

from calibration.cli import names_in
from calibration.experiment import read
from calibration.measurements.objective import ModelObjective
from calibration.report import write_page as write_report
from calibration.report.page import commands
from calibration.study import HeldOut


def test_coupons_alone(tmp_path: Path) -> None:
    results = [
        calibration(),
        calibration("ogden", chi2=86.0, note="no <correction>"),
        failed("mooney-rivlin"),
    ]
    path = write_report(tmp_path / "out", results, read(coupon_folder(tmp_path / "data")))
    page = Page(path)
    assert path == tmp_path / "out" / "report.html"
    names = {p.name for p in (tmp_path / "out" / "pictures").iterdir()}
    assert names == {"A-coupons.png", "A-parameters.png"}
    assert len(page.sources) == 2
    assert "No calibration: 1 of 3 fits" in page.text
    assert "mooney-rivlin: no equilibrium (nothing holds <there>)" in page.text
    assert page.row("neo-hookean")[2:4] == ["100.0 ± 0.7", "held at its prior, 300, not measured"]
    assert page.row("neo-hookean")[6] == "2.0"  # chi-square larger by 4, one constant fewer
    # the curve was made with the same law, incompressible
    error = page.row("pull-A")
    assert error[:3] == ["pull-A", "uniaxial", "15"]
    assert float(error[3].removesuffix(" %")) < 0.5
    assert float(error[4].removesuffix(" %")) > 5.0
    assert "ogden: no <correction>" in page.text
    assert "--material A" in page.text
    assert "Outlines" not in page.text


def test_a_note_of_several_laws_is_shown_once(tmp_path: Path) -> None:
    results = [calibration(note="free platens"), calibration("ogden", note="free platens")]
    page = Page(write_report(tmp_path, results, read(coupon_folder(tmp_path / "data"))))
    assert "neo-hookean, ogden: free platens" in page.text
    assert page.text.count("free platens") == 1


def test_all_fits_failed(tmp_path: Path) -> None:
    results = [failed(), failed("ogden"), failed(material="B")]
    page = Page(write_report(tmp_path, results, read(coupon_folder(tmp_path / "data"))))
    assert "A: no result, since no law has a fit (2 no equilibrium)." in page.text
    assert "B: no result, since no law has a fit (1 no equilibrium)." in page.text
    assert "3 fits: 3 no equilibrium" in page.text
    assert "--material" not in page.text  # the page has both materials of the experiment


def test_all_fits_of_beams_failed(tmp_path: Path) -> None:
    results = [replace(failed(), material="S1")]
    page = Page(write_report(tmp_path, results, read(beam_folder(tmp_path / "data"))))
    assert "no beam could be simulated" in page.text
    assert not page.sources


def test_stopped_without_estimates(tmp_path: Path) -> None:
    stopped = calibration(
        status="stopped", message="stopped after 3 generations", estimates=(), shear_modulus_sd=float("nan")
    )
    page = Page(write_report(tmp_path, [stopped], read(coupon_folder(tmp_path / "data"))))
    assert (
        "A: shear modulus 100.0 kPa by neo-hookean; the best so far of a search that was stopped" in page.text
    )
    assert page.row("neo-hookean")[1:5] == ["stopped", "100.0", "300, no error bar", "none"]
    assert {p.name for p in (tmp_path / "pictures").iterdir()} == {"A-coupons.png"}


def test_held_out_beams(tmp_path: Path) -> None:
    held = HeldOut(trial="hanging", shear_modulus=9.8e3, rms_raw=4e-4, rms=1.25e-4, reduced_chi2=1.21)
    soft = {"mu": 1e4, "lam": 3e6}
    u = (float(np.log(1e4)), float(np.log(300.0)))
    result = calibration(material="S1", rms=1e-4, held_out=(held,), parameters=soft, u=u)
    page = Page(write_report(tmp_path, [result], read(beam_folder(tmp_path / "data"))))
    assert page.row("hanging") == ["hanging", "50", "neo-hookean", "9.800", "0.400", "0.125", "1.21"]
    assert page.row("neo-hookean")[8] == "50 mm: 0.125"
    assert page.row("neo-hookean")[3] == "not identified; prior 300"
    names = {p.name for p in (tmp_path / "pictures").iterdir()}
    assert names == {"S1-held-out.png", "S1-parameters.png", "S1-residuals.png", "beam-hanging.png"}


def test_beams_without_equilibrium_at_the_parameters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # a true failure of the solver takes minutes
    monkeypatch.setattr(ModelObjective, "linearise", lambda _self, _u: False)
    result = calibration(material="S1", rms=1e-4)
    page = Page(write_report(tmp_path, [result], read(beam_folder(tmp_path / "data"))))
    assert "neo-hookean has no equilibrium at these parameters: nothing to draw" in page.text
    assert {p.name for p in (tmp_path / "pictures").iterdir()} == {"S1-parameters.png"}


def test_shape_constants_have_no_digits_where_nobody_sees_them(tmp_path: Path) -> None:
    unseen = (estimate(), estimate("alpha", value=7.6543, seen="not identified"))
    seen = (estimate(), estimate("second_share", value=0.2), estimate("bulk_ratio", value=250.0))
    results = [
        calibration("ogden", estimates=unseen, blind=({"alpha": 1.0, "bulk_ratio": -0.5},)),
        calibration("mooney-rivlin", estimates=seen, bulk_modulus=2.5e7),
    ]
    page = Page(write_report(tmp_path, results, read(coupon_folder(tmp_path / "data"))))
    assert page.row("ogden")[4] == "alpha not identified"
    assert "7.65" not in page.text
    assert page.row("mooney-rivlin")[3:5] == ["250", "C01 / (C10 + C01) 0.200 [0.196, 0.204]"]
    assert "ogden: the data do not determine alpha up and K/G down by 0.50 as much of its range" in page.text


def test_without_results(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="at least one calibration"):
        write_report(tmp_path, [], read(coupon_folder(tmp_path / "data")))
    assert not (tmp_path / "report.html").exists()


def test_commands_of_a_page_name_materials_with_a_comma(tmp_path: Path) -> None:
    folder = coupon_folder(tmp_path / "data")
    text = (folder / "experiment.yaml").read_text(encoding="utf-8")
    content = yaml.safe_load(text.replace("material: A", "material: Eco 30, batch 2"))
    content["materials"]["Eco 30, batch 2"] = content["materials"].pop("A")
    (folder / "experiment.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")
    (line,) = commands(tmp_path, [calibration(material="Eco 30, batch 2")], read(folder))
    words = shlex.split(line)
    assert names_in(words[words.index("--material") + 1]) == ["Eco 30, batch 2"]


def test_fits_of_several_runs_have_a_command_each(tmp_path: Path) -> None:
    """Of all fits in one folder the options of the first were printed."""
    timed = replace(calibration(), label="neo-hookean+prony-1", parts=("prony:1",))
    two = replace(calibration("ogden"), label="ogden-2")
    fits = [timed, calibration("ogden"), two, calibration("mooney-rivlin"), calibration()]
    (tmp_path / "fits").mkdir()
    for r in fits:
        header = {"seed": 5 if r.law == "mooney-rivlin" else 1, "held_out": True}
        path = tmp_path / "fits" / f"{r.material}-{r.label}.json"
        path.write_text(json.dumps({"header": header}), encoding="utf-8")
    found = commands(tmp_path, fits, read(coupon_folder(tmp_path / "data")))
    start = f"python -m calibration.fit {tmp_path / 'data'} --model"
    end = f"--out {tmp_path}"
    assert found == [
        f"{start} neo-hookean --material A --time prony:1 --seed 1 {end}",
        f"{start} ogden,neo-hookean --material A --seed 1 {end}",
        f"{start} ogden --material A --terms 2 --seed 1 {end}",
        f"{start} mooney-rivlin --material A --seed 5 {end}",
    ]
    # the number of terms was left to the data: so does the command that makes the fit again
    chosen = replace(timed, asked=("prony",))
    assert commands(tmp_path, [chosen], read(tmp_path / "data")) == [
        f"{start} neo-hookean --material A --time prony --seed 1 {end}"
    ]
    assert commands(tmp_path, [calibration(), two], read(tmp_path / "data")) == [
        f"{start} neo-hookean,ogden --material A --terms 2 --seed 1 {end}"
    ]
