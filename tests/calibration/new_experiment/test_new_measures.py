"""Measures of strain and stress, sizes of several specimens, simple shear, signs: from columns to a curve."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment import CouponTrial, read
from calibration.new._asking import Nobody
from calibration.new._build import build
from calibration.new._read import read_answers

Array = NDArray[np.float64]
TIME = 0.5 * np.arange(16)
STRETCH = np.linspace(1.0, 1.3, 16)
NOMINAL = 20e3 * (STRETCH - STRETCH**-2)  # Pa
LENGTH, AREA = 20.0, 50.0  # mm, mm2
SIZE = {"rest_length_mm": LENGTH, "area_mm2": AREA}


def trial(folder: Path, text: str | bytes, name: str = "f.csv", **answers: Any) -> CouponTrial:
    folder.mkdir(exist_ok=True)
    (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)
    own = {"id": "c", "kind": "coupon", "material": "M", "file": name, "mode": "uniaxial", **answers}
    (folder / "a.yaml").write_text(yaml.safe_dump({"name": "x", "trials": [own]}), encoding="utf-8")
    asker = Nobody(folder / "a.yaml")
    build(read_answers(asker.path, asker), folder, folder / "out", asker)
    (found,) = read(folder / "out").trials
    assert isinstance(found, CouponTrial)
    return found


def table(separator: str = ",", **columns: Array) -> str:
    rows = np.column_stack(list(columns.values()))
    lines = [separator.join(columns), *(separator.join(f"{v:.9g}" for v in row) for row in rows)]
    return "\n".join(lines) + "\n"


def columns(strain: str, by: Array, stress: str, load: Array) -> str:
    return table(**{"Time [s]": TIME, f"{strain} [-]": by, f"{stress} [kPa]": 1e-3 * load})


@pytest.mark.parametrize(
    ("strain", "stress"),
    [
        ("True strain", "True stress"),
        ("Strain (true)", "Stress (true)"),
        ("Strain true", "Stress_true"),
        ("Natural strain", "Stress (Cauchy)"),
        ("Logarithmische Dehnung", "Wahre Spannung"),
        ("Déformation vraie", "Contrainte vraie"),
        ("Déformation logarithmique", "Contrainte de Cauchy"),
    ],
)
def test_true_measures_are_known_in_any_order_of_words(tmp_path: Path, strain: str, stress: str) -> None:
    text = columns(strain, np.log(STRETCH), stress, NOMINAL * STRETCH)
    found = trial(tmp_path, text, displacement_positive="tension")
    np.testing.assert_allclose(found.stretch, STRETCH, rtol=1e-6)
    np.testing.assert_allclose(found.stress, NOMINAL, rtol=1e-6, atol=1e-3)


@pytest.mark.parametrize(
    "strain", ["Green strain", "Green-Lagrange strain", "Lagrangian strain", "Almansi strain"]
)
def test_other_measures_are_not_taken_for_engineering_ones(tmp_path: Path, strain: str) -> None:
    text = columns(strain, 0.5 * (STRETCH**2 - 1.0), "Stress", NOMINAL)
    with pytest.raises(InputError, match="expected a column of stretch"):
        trial(tmp_path, text)
    piola = columns("Strain", STRETCH - 1.0, "2nd Piola-Kirchhoff stress", NOMINAL / STRETCH)
    with pytest.raises(InputError, match="expected a column of stress"):
        trial(tmp_path, piola)


def test_an_elongation_ratio_is_a_stretch_and_the_first_piola_stress_is_the_nominal_one(
    tmp_path: Path,
) -> None:
    found = trial(tmp_path, columns("Elongation ratio", STRETCH, "First Piola-Kirchhoff stress", NOMINAL))
    np.testing.assert_allclose(found.stretch, STRETCH, rtol=1e-6)
    np.testing.assert_allclose(found.stress, NOMINAL, rtol=1e-6, atol=1e-3)


def raw(area: float) -> str:
    rows = zip(TIME, (STRETCH - 1.0) * LENGTH, NOMINAL * area * 1e-6, strict=True)
    return "Time,Extension,Load\n(s),(mm),(N)\n" + "".join(f"{a:g},{b:.9g},{c:.9g}\n" for a, b, c in rows)


def test_each_specimen_of_a_file_has_its_own_size(tmp_path: Path) -> None:
    """A cylinder, then a strip: its section is not the cylinder's."""
    head = "Specimen properties : "
    strip = f"\nSpecimen name : B,2,\n{head}Width,10,mm\n{head}Thickness,3,mm\n{raw(30.0)}"
    two = f"Specimen name : A,1,\n{head}Diameter,14,mm\n{raw(np.pi / 4 * 14.0**2)}{strip}"
    for number in (1, 2):
        found = trial(tmp_path / str(number), two, test=number, rest_length_mm=LENGTH)
        np.testing.assert_allclose(found.stress, NOMINAL, rtol=1e-6, atol=1e-3)
    without = f"{head}Diameter,14,mm\n{raw(154.0)}\nSpecimen name : B,2,\n{raw(30.0)}"
    with pytest.raises(InputError, match="area_mm2"):
        trial(tmp_path / "none", without, test=2, rest_length_mm=LENGTH)
    both = f"{head}Diameter,14,mm\n{head}Width,10,mm\n{head}Thickness,3,mm\n{raw(30.0)}"
    with pytest.raises(InputError, match="area_mm2"):
        trial(tmp_path / "both", both, rest_length_mm=LENGTH)


def test_a_headers_number_is_read_as_those_of_the_table(tmp_path: Path) -> None:
    """An area of 1,256 mm2 was read as 1.256, a thousandth, and a length of 1,050.0 mm not at all."""
    head = 'Specimen properties : Area,"1,256",mm^2\nSpecimen properties : Length,"1,050.0",mm\n'
    rows = raw(1256.0).splitlines()[2:]
    long = "".join(f"{t},{float(x) * 1050.0 / LENGTH:.9g},{f}\n" for t, x, f in (r.split(",") for r in rows))
    units = "Time,Extension,Load\n(s),(mm),(N)\n"
    found = trial(tmp_path / "point", f"{head}{units}{long}")
    np.testing.assert_allclose(found.stretch, STRETCH, rtol=1e-6)
    np.testing.assert_allclose(found.stress, NOMINAL, rtol=1e-6, atol=1e-3)
    whole = units + "".join(f"{k},{k},{10 * k}\n" for k in range(1, 9))
    with pytest.raises(InputError, match=r"'1,256' may be either: state decimals"):
        trial(tmp_path / "either", head + whole, rest_length_mm=50.0)


def test_a_line_of_text_within_raw_data_is_refused(tmp_path: Path) -> None:
    lines = raw(AREA).splitlines()
    text = "\n".join([f"Specimen properties : Length,{LENGTH:g},mm", *lines[:8], "Ramp 2", *lines[8:]]) + "\n"
    with pytest.raises(InputError, match=r"line 10: .*this line of text stands within raw data"):
        trial(tmp_path, text, area_mm2=AREA)


def test_a_headers_length_and_section_are_not_those_of_a_shear(tmp_path: Path) -> None:
    gamma = np.linspace(0.0, 0.5, 16)
    columns_ = {"Time [s]": TIME, "Displacement [mm]": 4.0 * gamma, "Force [N]": 20e3 * gamma * 800e-6}
    sizes = (("Length", 40), ("Width", 20), ("Thickness", 4))
    head = "".join(f"Specimen properties : {name},{size},mm\n" for name, size in sizes)
    with pytest.raises(InputError, match="height over which the specimen is sheared"):
        trial(tmp_path, head + table(**columns_), mode="simple-shear", displacement_positive="tension")
    with pytest.raises(InputError, match="the sheared area, along which the force acts"):
        trial(
            tmp_path / "area",
            head + table(**columns_),
            mode="simple-shear",
            rest_length_mm=4.0,
            displacement_positive="tension",
        )
    stated = {"rest_length_mm": 4.0, "area_mm2": 800.0, "displacement_positive": "tension"}
    found = trial(tmp_path / "stated", head + table(**columns_), mode="simple-shear", **stated)
    np.testing.assert_allclose(found.stretch, 1.0 + gamma, rtol=1e-6)
    np.testing.assert_allclose(found.stress, 20e3 * gamma, rtol=1e-6, atol=1e-3)


@pytest.mark.parametrize(
    ("strain", "stress"), [("Strain", "Compressive stress"), ("Dehnung", "Druckspannung")]
)
def test_a_push_that_another_column_states_is_asked_for(tmp_path: Path, strain: str, stress: str) -> None:
    text = columns(strain, np.linspace(0.0, 0.3, 16), stress, np.linspace(0.0, 27e3, 16))
    with pytest.raises(InputError, match="displacement_positive"):
        trial(tmp_path, text)
    found = trial(tmp_path, text, displacement_positive="compression")
    assert found.stretch[-1] == pytest.approx(0.7)
    assert found.stress[-1] == pytest.approx(-27e3)


def test_shares_shown_in_percent_are_what_the_header_says(tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    for header in ("Strain [mm/mm]", "Strain [%]"):
        book = openpyxl.Workbook()
        book.active.append(["Time [s]", header, "Stress [kPa]"])
        for row in zip(TIME, STRETCH - 1.0, 1e-3 * NOMINAL, strict=True):
            book.active.append([float(v) for v in row])
        for (cell,) in book.active.iter_rows(min_row=2, min_col=2, max_col=2):
            cell.number_format = "0.0%"
        written = io.BytesIO()
        book.save(written)
        found = trial(tmp_path / header[8:9].strip("%"), written.getvalue(), "f.xlsx")
        np.testing.assert_allclose(found.stretch, STRETCH, rtol=1e-6)


def test_thousands_between_semicolons_are_no_decimals(tmp_path: Path) -> None:
    rows = [f"{k};{k};{1000 + 37 * k:,d}".replace(",", ".") for k in range(16)]
    text = "\n".join(["Zeit [s];Weg [mm];Kraft [mN]", *rows]) + "\n"
    with pytest.raises(InputError, match=r"'1\.000' may be either: state decimals"):
        trial(tmp_path, text, **SIZE, displacement_positive="tension")
    found = trial(tmp_path, text, **SIZE, displacement_positive="tension", decimals="comma")
    assert found.stress[-1] == pytest.approx(1.555 / 50e-6)


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        ({"displacement_positive": "tension"}, "column of stretch"),
        ({"leave_out_rows": True}, "column of time"),
    ],
)
def test_answers_without_effect_are_refused(tmp_path: Path, answers: dict[str, Any], words: str) -> None:
    text = table(**{"Stretch [-]": STRETCH, "Stress [kPa]": 1e-3 * NOMINAL})
    with pytest.raises(InputError, match=words):
        trial(tmp_path, text, **answers)
