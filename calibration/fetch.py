"""`python -m calibration.fetch`: public measurements from their sources, checked, as an experiment.

Needs pooch (`pip install 'tisim[fetch]'`). Nothing of the data is in this package: files come from where
their authors published them, at one fixed version, and are refused where their sha256 differs.

A further source is one `Source` and one `register`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Annotated

import typer

from calibration.cli import command, plain_ends
from calibration.errors import InputError
from tisim.options import Version

app = command()


@dataclass(frozen=True, kw_only=True)
class Source:
    """Published measurements.

    Attributes
    ----------
    name : on the command line.
    about : the measurements, and what is not stated, in a sentence or two.
    cite : whom to cite.
    licence : its name. licence_file : that holds its text, one of `files`.
    base : URL of the version that is taken; a file's path follows it.
    files : sha256 by path below `base`.
    write : makes experiment.yaml and its records below a folder, from the files by their paths.
    """

    name: str
    about: str
    cite: str
    licence: str
    licence_file: str
    base: str
    files: Mapping[str, str]
    write: Callable[[Path, Mapping[str, Path]], None]


_SOURCES: dict[str, Source] = {}


def register(source: Source) -> None:
    """Make a source known. ValueError where its name is taken."""
    if source.name in _SOURCES:
        raise ValueError(f"source {source.name}: it is registered already")
    _SOURCES[source.name] = source


def sources() -> tuple[Source, ...]:
    """All sources that are known."""
    return tuple(_SOURCES.values())


def fetch(name: str, folder: str | Path, *, base: str | None = None) -> Path:
    """Download a source's files and write them as an experiment.

    Parameters
    ----------
    name : name of a source.
    folder : empty or not there yet. It gets experiment.yaml, the records, source/ with the files as they
        came, and SOURCE.md with the licence and whom to cite.
    base : URL of a mirror, in place of the source's own.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    InputError
        The source is unknown, the folder is not empty, a file cannot be had or is not what it was.
    """
    import pooch

    if name not in _SOURCES:
        raise InputError(f"{name}: expected one of {', '.join(_SOURCES)}")
    source, folder = _SOURCES[name], Path(folder)
    # files of a fetch that was cut off may be there: each is compared with its checksum
    if folder.exists() and (not folder.is_dir() or any(p.name != "source" for p in folder.iterdir())):
        raise InputError(f"--out {folder}: expected an empty folder, or none yet")
    raw = folder / "source"
    found: dict[str, Path] = {}
    for path, digest in source.files.items():
        url = f"{base or source.base}/{path}"
        try:
            got = pooch.retrieve(
                url,
                known_hash=f"sha256:{digest}",
                path=raw,
                fname=PurePosixPath(path).name,
                progressbar=False,
            )
        except ValueError as error:  # the checksum
            raise InputError(f"{url}: expected the file as it was published ({error})") from None
        except OSError as error:  # no network, no such file
            raise InputError(f"{url}: cannot be had ({error})") from None
        found[path] = Path(got)
    source.write(folder, found)
    text = found[source.licence_file].read_text(encoding="utf-8")
    (folder / "SOURCE.md").write_text(
        f"# {source.name}\n\n{source.about}\n\nFrom {source.base}\nCite: {source.cite}\n"
        f"Licence: {source.licence}\n\n{text}",
        encoding="utf-8",
    )
    return folder


# -- Ecoflex cylinders in compression --

_CYLINDERS = {
    "EF10_0T/EF10_0T_A1.csv": "0054d475654aedffcbf0e848453166d807dba0581332e42bb85ffde3537f5dd6",
    "EF30_0T/EF30_0T_A1.csv": "61a8d0233f3c97327858e9d202f7efd1df87fc5cebdb117b9743c40cc9bfedb5",
    "EF30_0T/EF30_0T_A2.csv": "dab79d318f8fb18c3ffb9abdfc9530878ff476164a4e79e0ed6b4241938474f6",
    "EF30_0T/EF30_0T_A3.csv": "57950aa7b8186acb3f0c2250fa4c8cc972fa42e6f745d8e391ea70bb1ea6832a",
    "EF30_0T/EF30_0T_A4.csv": "44e7e71abf8ae19fda438a8a462fcea0eed258cf56d2e53e8125e2123970ddaf",
    "EF30_0T/EF30_0T_A5.csv": "2fcf490633a8a58026d1be5364f14acc421ed7ae31c3d417a340f7f56f178547",
    "EF50_0T/EF50_0T_A1.csv": "e8368f5b240982ca87b35d981909f187108a6cf12f5266d31f5e51a9c2a20854",
}


def _write_cylinders(folder: Path, found: Mapping[str, Path]) -> None:
    """Stretch, engineering stress and time of each test; loading only."""
    (folder / "coupons").mkdir(parents=True)
    materials: dict[str, None] = {}
    trials = []
    for path in _CYLINDERS:
        lines = found[f"data/{path}"].read_text(encoding="utf-8-sig").splitlines()
        head = next((k for k, line in enumerate(lines) if line.startswith("Time (s),")), None)
        if head is None:
            raise InputError(f"{path}: expected a line that begins with Time (s)")
        columns = lines[head].split(",")
        at = [columns.index(c) for c in ("Engineering Strain [-]", "Engineering Stress (kPa)", "Time (s)")]
        rows = ["stretch,nominal_stress_kPa,time_s"]
        for line in filter(str.strip, lines[head + 1 :]):
            strain, stress, time = (float(line.split(",")[k]) for k in at)
            rows.append(f"{1.0 + strain:.7g},{stress:.7g},{time:.7g}")
        name = PurePosixPath(path).stem.replace("_", "-")
        (folder / "coupons" / f"{name}.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        material = name.split("-")[0]
        materials[material] = None
        trials.append(
            f"  - id: {name}\n    kind: coupon\n    material: {material}\n    mode: uniaxial\n"
            f"    record: coupons/{name}.csv\n"
        )
    (folder / "experiment.yaml").write_text(
        "format: 1\nname: Ecoflex cylinders in compression\n"
        "notes: between platens, 10 mm/min, cylinders of 50 x 30 mm; lubrication not stated\nmaterials:\n"
        + "".join(f"  {m}: {{}}\n" for m in materials)
        + "trials:\n"
        + "".join(trials),
        encoding="utf-8",
    )


register(
    Source(
        name="ecoflex-cylinders",
        about="Cylinders of Smooth-On Ecoflex 00-10, 00-30 and 00-50, 50 mm wide and 30 mm high, compressed"
        " by two thirds at 10 mm/min; five tests of one sample of 00-30, one of the others. Not stated:"
        " whether the platens were lubricated, the pause between tests, errors.",
        cite="Dawood et al., tissue-phantom-material-database, 2026 (CITATION.cff beside the files)",
        licence="CC BY 4.0",
        licence_file="DATA_LICENSE.md",
        base="https://raw.githubusercontent.com/abubakardawood/tissue-phantom-material-database/"
        "52b1271f0f8a966c168e5ddc0886190f12c6551f",
        files={
            **{f"data/{path}": digest for path, digest in _CYLINDERS.items()},
            "DATA_LICENSE.md": "d5d7f11d9d94dfa99232c6bf866e562dc28dd57c1601ce7a183a1265d2a1b840",
            "CITATION.cff": "50653e787b78ea319aaec898d72a02f095238087b7e0c0fc5225c45f1755c987",
        },
        write=_write_cylinders,
    )
)

EXAMPLES = """
[bold]Examples[/bold]

What there is, with licences:

  python -m calibration.fetch

Cylinders of silicone in compression, as an experiment, and what their simulation gets wrong:

  python -m calibration.fetch ecoflex-cylinders --out cylinders
  python -m calibration.diagnose cylinders --out diagnosed

Exit codes: 0 done, 2 bad input, no network, or a file that is not what it was.
"""


@app.command(epilog=EXAMPLES)
def main(
    name: Annotated[str | None, typer.Argument(help="Name of the source. Default: list all.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder of the experiment. Default: NAME.")] = None,
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """Download public measurements as an experiment."""
    with plain_ends():
        if name is None:
            for source in sources():
                typer.echo(f"{source.name} ({source.licence}): {source.about}")
            return
        folder = fetch(name, out or Path(name))
        source = _SOURCES[name]
        typer.echo(f"{folder}: {len(source.files)} files, {source.licence}; cite {source.cite}")


if __name__ == "__main__":
    app()
