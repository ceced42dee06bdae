"""Files of testing machines: the format is identified by the content, and numbers are read exactly."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest
from lab_columns import column

from calibration.errors import InputError
from calibration.lab_files import (
    Importer,
    LabFile,
    importers,
    name_and_unit,
    read_lab_file,
    register,
)
from calibration.lab_files import _formats as formats
from calibration.lab_files._quantities import quantity

SAMPLES = Path(__file__).resolve().parents[3] / "datasets" / "lab-files"


def write(folder: Path, name: str, text: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def test_the_examples_are_what_their_maker_writes(tmp_path: Path) -> None:
    runpy.run_path(str(SAMPLES / "make.py"))["main"](tmp_path)
    for path in tmp_path.iterdir():
        assert path.read_bytes() == (SAMPLES / path.name).read_bytes(), path.name


@pytest.mark.parametrize(
    ("header", "name", "unit", "holds"),
    [
        ("Force [N]", "Force", "N", "force"),
        ("Extension (mm)", "Extension", "mm", "displacement"),
        ("strain %", "strain", "%", "strain"),
        ("Time/s", "Time", "s", "time"),
        ("Fz, gf", "Fz", "gf", "force"),
        ("Position (z), mm", "Position (z)", "mm", "displacement"),
        ("depth_mm", "depth", "mm", "displacement"),
        ("Dehnung in %", "Dehnung", "%", "strain"),
        ("Dehnung [mm]", "Dehnung", "mm", "displacement"),
        ("Contrainte (MPa)", "Contrainte", "MPa", "stress"),
        ("Tensile strain (Extension) (mm/mm)", "Tensile strain (Extension)", "mm/mm", "strain"),
        ("Tensile strain (Extension)", "Tensile strain (Extension)", None, "strain"),
        ("True Stress (MPa)", "True Stress", "MPa", "true-stress"),
        ("Weg (µm)", "Weg", "µm", "displacement"),
        ("Standardkraft", "Standardkraft", None, "force"),
        ("Oscillation strain (%)", "Oscillation strain", "%", None),
        ("Cycle count", "Cycle count", None, None),
        ("Shear rate (1/s)", "Shear rate", "1/s", None),
        ("Stress (mpa)", "Stress (mpa)", None, "stress"),  # milli or mega: refused
        ("Torque (N.m)", "Torque", "N.m", None),
        ("Time at Break (s)", "Time at Break", "s", None),
        ("Date and time", "Date and time", None, None),
        ("Strain constant", "Strain constant", None, None),
        ("Strain ratio", "Strain ratio", None, None),
        ("Stretch ratio", "Stretch ratio", None, "stretch"),
        ("Dehnung mm/mm", "Dehnung", "mm/mm", "strain"),
        ("Elongation in/in", "Elongation", "in/in", "strain"),
        ("Stress, N/mm²", "Stress", "N/mm²", "stress"),
        ("Spannung in N/mm²", "Spannung", "N/mm²", "stress"),
        ("Stress/N/mm²", "Stress", "N/mm²", "stress"),
        ("Kraft / N", "Kraft", "N", "force"),
        ("Strain rate %/d", "Strain rate %/d", None, None),
        ("Compression force (N)", "Compression force", "N", "force"),
        ("Indentation load", "Indentation load", None, "force"),
        ("Stroke force [mN]", "Stroke force", "mN", "force"),
        ("Calibrated force (N)", "Calibrated force", "N", "force"),
        ("Compression (mm)", "Compression", "mm", "displacement"),
        ("Dehnrate (1/s)", "Dehnrate", "1/s", None),
    ],
)
def test_headers_state_a_quantity_and_a_unit(
    header: str, name: str, unit: str | None, holds: str | None
) -> None:
    found, given = name_and_unit(header)
    assert (found, None if given is None else given.text) == (name, unit)
    assert quantity(found, given) == holds


@pytest.mark.parametrize(
    ("file", "format", "names"),
    [
        ("instron.csv", "instron", [""]),
        ("zwick.txt", "zwick", ["Druckversuch 1", "Druckversuch 2"]),
        ("trios.txt", "trios", ["Conditioning (25.0 °C)", "Stress growth (25.0 °C)"]),
        ("mach-1.txt", "mach-1", ["Find Contact", "Move Relative"]),
        ("plain.csv", "csv", [""]),
    ],
)
def test_a_format_is_found_from_the_content(file: str, format: str, names: list[str], tmp_path: Path) -> None:
    copy = tmp_path / "record.dat"  # the name states no format
    copy.write_bytes((SAMPLES / file).read_bytes())
    found, tests = read_lab_file(copy)
    assert (found, [t.name for t in tests]) == (format, names)
    own = [i.name for i in importers() if formats._recognises(i, tests[0].file)]
    assert own == [format]  # and no other format matches


def test_decimal_commas_and_parameters_of_instron() -> None:
    _, (test,) = read_lab_file(SAMPLES / "instron.csv")
    assert column(test, "Extension")[[0, 30, 60]] == pytest.approx([0.0, 25e-3, 50e-3])
    assert column(test, "Load")[-1] == pytest.approx(0.875, abs=0.01)
    assert test.parameters["Specimen properties : Length"] == "50,0 mm"
    assert test.rows[0] == 9


def test_instron_with_units_in_its_header_and_a_table_of_results(tmp_path: Path) -> None:
    """Two layouts of Bluehill: parameters above a header with units; results above the raw data."""
    header = (
        "Machine;Instron 5569\nLength (mm);33\n\nTime (s);Engineering Strain (%);Engineering Stress (MPa)\n"
    )
    rows = "0;0;0\n0.1;5;0.004\n0.2;10;0.007\n"
    found, (test,) = read_lab_file(write(tmp_path, "a.csv", header + rows))
    assert found == "instron"
    assert column(test, "Engineering Strain") == pytest.approx([0.0, 0.05, 0.1])
    text = (
        '"Results Table 1"\n"","Maximum Load","Modulus"\n"","(N)","(MPa)"\n"1","12,5","0,3"\n\n'
        'Time,Extension,Load,Tensile stress\n(s),(mm),(N),(MPa)\n"0,0","0,0","0,0","0,0"\n'
        '"0,1","1,0","2,5","0,1"\n"0,2","2,0","5,0","0,2"\n'
    )
    found, (test,) = read_lab_file(write(tmp_path, "b.csv", text))
    assert found == "instron"
    assert column(test, "Load") == pytest.approx([0.0, 2.5, 5.0])


def test_mach1_has_gram_force_and_ramps(tmp_path: Path) -> None:
    _, tests = read_lab_file(SAMPLES / "mach-1.txt")
    assert column(tests[1], "Fz")[-1] == pytest.approx(-1.2, abs=0.01)
    text = (SAMPLES / "mach-1.txt").read_text(encoding="utf-8")
    lines = text.splitlines()
    lines.insert(len(lines) - 10, "<divider>")
    _, tests = read_lab_file(write(tmp_path, "ramps.txt", "\n".join(lines)))
    assert [(t.name, len(t.rows)) for t in tests[1:]] == [
        ("Move Relative, ramp 1", 42),
        ("Move Relative, ramp 2", 9),
    ]


def test_both_text_exports_of_trios(tmp_path: Path) -> None:
    lims = column(read_lab_file(SAMPLES / "trios.txt")[1][1], "Strain")
    assert lims[-1] == pytest.approx(0.5)
    text = (
        "Filename\ta.tri\n\n[step]\nStress growth - 1\nStep time\tStrain\tStress\ns\t%\tPa\n"
        "0.1\t1\t250\n0.2\t2\t500\n0.3\t3\t750\n\n[file parameters]\nx\t1\n"
    )
    _, (test,) = read_lab_file(write(tmp_path, "plain.txt", text))
    assert test.name == "Stress growth - 1"
    assert column(test, "Strain") == pytest.approx([0.01, 0.02, 0.03])


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_texts_of_windows_are_read(encoding: str, tmp_path: Path) -> None:
    text = (SAMPLES / "zwick.txt").read_text(encoding="utf-8").replace("\n", "\r\n")
    _, tests = read_lab_file(write(tmp_path, "a.txt", text.encode(encoding)))
    assert column(tests[1], "Standardweg")[-1] == pytest.approx(4.5e-3)


def test_thousands_are_told_from_decimals(tmp_path: Path) -> None:
    text = "Time (s);Force (N);Weg (mm)\n" + "".join(f"{k};1.{k}00,5;0,{k}\n" for k in range(1, 5))
    _, (test,) = read_lab_file(write(tmp_path, "a.csv", text))
    assert column(test, "Force") == pytest.approx([1100.5, 1200.5, 1300.5, 1400.5])


def test_thousands_without_decimals_are_read(tmp_path: Path) -> None:
    text = "Time (s);Extension (mm);Force (mN)\n0,5;0,1;980\n1,0;0,2;1.080\n1,5;0,3;1.234.567\n"
    _, (test,) = read_lab_file(write(tmp_path, "a.csv", text))
    assert column(test, "Force").tolist() == pytest.approx([0.98, 1.08, 1234.567])
    text = "Time (s);Force (mN)\n1;980\n2;1,080\n3;2,639\n"
    _, (test,) = read_lab_file(write(tmp_path, "b.csv", text))
    (found,) = test.with_quantity("force")
    assert test.numbers(found, "point").tolist() == [980.0, 1080.0, 2639.0]
    with pytest.raises(InputError, match="may be either: state decimals"):
        test.numbers(found)


@pytest.mark.parametrize("odd", ["lbf/in", "cN/tex", "J/g"])
def test_a_row_of_units_may_hold_one_that_is_not_known(odd: str, tmp_path: Path) -> None:
    rows = "".join(f"{k};{0.1 * k:.1f};{0.02 * k:.2f};{k}\n" for k in range(5))
    path = write(tmp_path, "a.txt", f"testXpert\nZeit;Weg;Kraft;Sonst\ns;mm;N;{odd}\n{rows}")
    format, (test,) = read_lab_file(path)
    assert format == "zwick"
    assert len(test.rows) == 5
    assert [c.unit and c.unit.text for c in test.columns] == ["s", "mm", "N", None]
    # names alone are no units: of these two words most are none
    words = write(tmp_path, "b.txt", f"Zeit;Weg;Kraft;Sonst\ns;Weg;Kraft;{odd}\n{rows}")
    with pytest.raises(InputError):
        read_lab_file(words, format="zwick")


def test_a_short_step_does_not_refuse_its_file(tmp_path: Path) -> None:
    text = (SAMPLES / "trios.txt").read_text(encoding="utf-8")
    step = text.lower().index("[step]")
    short = "[step]\nConditioning\nTime\tStrain\ns\t%\n0.0\t1.0\n\n"
    _, tests = read_lab_file(write(tmp_path, "a.txt", text[:step] + short + text[step:]))
    assert [t.name for t in tests] == [t.name for t in read_lab_file(SAMPLES / "trios.txt")[1]]
    with pytest.raises(InputError, match="expected at least 3 rows of numbers, got 1"):
        read_lab_file(write(tmp_path, "b.txt", text[:step] + short))


def test_a_step_of_trios_without_units_keeps_its_first_row(tmp_path: Path) -> None:
    text = "[step]\nAxial\nStep time\tStretch\n\t\n" + "".join(f"{k}.0\t{1 + 0.1 * k}\n" for k in range(5))
    _, (test,) = read_lab_file(write(tmp_path, "a.txt", text))
    assert len(test.rows) == 5


def test_a_further_format_is_one_registration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(formats, "_IMPORTERS", dict(formats._IMPORTERS))
    _, expected = read_lab_file(SAMPLES / "plain.csv")

    def recognises(file: LabFile) -> bool:
        return file.rows[0].text.startswith("#ours")

    register(Importer(name="ours", about="for a test", recognises=recognises, read=lambda _: expected))
    path = write(tmp_path, "a.dat", "#ours\n\nx")
    assert read_lab_file(path) == ("ours", expected)
    with pytest.raises(ValueError, match="importer ours: it is registered already"):
        register(Importer(name="ours", about="", recognises=recognises, read=lambda _: ()))


def test_two_formats_are_never_guessed_between(tmp_path: Path) -> None:
    path = write(tmp_path, "a.txt", "Instron 5569\nTime;Load\ns;N\n0;1\n1;2\n2;3\n")
    with pytest.raises(InputError) as caught:
        read_lab_file(path)
    assert str(caught.value) == (
        f"{path}: it reads as instron and as zwick: expected one format, state which (format)"
    )
    assert read_lab_file(path, format="zwick")[0] == "zwick"


@pytest.mark.parametrize("file", ["instron.csv", "zwick.txt", "trios.txt", "mach-1.txt", "plain.csv"])
def test_damage_is_read_or_refused_in_a_sentence(file: str, tmp_path: Path) -> None:
    """Changed, removed or inserted bytes, 40 times: no error other than InputError occurs."""
    rng = np.random.default_rng(7)
    whole = (SAMPLES / file).read_bytes()
    for _ in range(40):
        content = bytearray(whole)
        for _ in range(rng.integers(1, 5)):
            at, length = int(rng.integers(len(content))), int(rng.integers(1, 100))
            match rng.integers(3):
                case 0:
                    content[at] = int(rng.integers(256))
                case 1:
                    del content[at : at + length]
                case _:
                    content[at:at] = content[length : 2 * length]
        path = write(tmp_path, "damaged.txt", bytes(content))
        said = f"{path}:"
        try:
            for test in read_lab_file(path)[1]:
                for given in test.columns:
                    test.numbers(given)
        except InputError as error:
            said = str(error)
        assert said.startswith(f"{path}:")
        assert "\n" not in said
