"""An experiment's folder from answers: made beside its place, read as commands read it, then moved there."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from calibration.errors import InputError
from calibration.experiment import PHOTOGRAPHS, Experiment, read, read_photo_settings
from calibration.new._answers import Answers, BeamAnswers, CouponAnswers, PokeAnswers
from calibration.new._asking import Asker, some_text
from calibration.new._beam import bar, density, make_beam
from calibration.new._board import board_pdf
from calibration.new._coupon import make_coupon
from calibration.new._photographs import WHERE, photo_settings
from calibration.new._plausible import CHECKS, Made
from calibration.new._poke import make_poke
from calibration.new._trial import Work

ANSWERS = "answers.yaml"
BOARD = "board.pdf"


@dataclass(frozen=True, kw_only=True)
class Built:
    """A folder that was made.

    Attributes
    ----------
    folder : Path
    experiment : Experiment
        As every command reads it.
    defaults : tuple of str
        What was taken by default or from headers of files, a sentence each.
    """

    folder: Path
    experiment: Experiment
    defaults: tuple[str, ...]


def check_target(out: Path) -> None:
    """Refuse a folder that holds something.

    Raises
    ------
    InputError
        It does.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(f"--out {out}: expected an empty folder, or none yet")


def build(answers: Answers, base: Path, out: Path, asker: Asker, raw: dict[str, Any] | None = None) -> Built:
    """Make an experiment's folder.

    Parameters
    ----------
    answers : Answers
    base : Path
        Folder that the answers' paths are relative to.
    out : Path
        Folder to make: empty, or none yet.
    asker : Asker
        Who is asked what the answers leave open.
    raw : dict, optional
        The answers as they will be written beside the experiment, to which the asker adds; the answers
        themselves where left out.

    Raises
    ------
    InputError
        Something is missing, damaged or implausible; nothing is written.
    """
    check_target(out)
    work = Work(base=base, asker=asker)
    materials = {
        name: m.model_dump(exclude_none=True, exclude_unset=True) for name, m in answers.materials.items()
    }
    trials = []
    for entry in answers.trials:
        try:
            trials.append(_trial(work, entry, materials))
        except InputError:
            if not asker.lacks:  # else it may be of what stands in for a missing answer
                raise
    asker.complete()
    used = dict.fromkeys(trial["material"] for trial in trials)
    for name in answers.materials:
        if name not in used:  # misspelt, as a rule, and what is known of it would be lost
            raise InputError(
                f"{asker.place}: key materials.{name}: expected a material of a trial ({', '.join(used)})"
            )
    for name in used:
        materials.setdefault(name, {})
    photographed = any("photo" in c for trial in trials for c in trial.get("captures", ()))
    settings = photo_settings(work, answers.photographs) if photographed else {}
    board = None if answers.board is None else board_pdf(answers.board, f"{asker.place}: key board.square_mm")
    notes = answers.notes
    if work.defaults:
        notes = "\n".join(
            filter(None, [notes, f"Not stated by the lab: {', '.join(map(_key, work.defaults))}."])
        )
    content: dict[str, Any] = {"format": 1, "name": answers.name}
    if notes:
        content["notes"] = notes
    content |= {"materials": materials, "trials": trials}
    if raw is None:
        raw = answers.model_dump(exclude_unset=True)
    own = _plain(raw)
    for trial in own["trials"]:
        _move_paths(trial, base, {path: name for name, path in work.copies.items()})
    if settings:
        own[WHERE] = settings
    texts = {"experiment.yaml": _head(work.defaults) + dump(content), ANSWERS: dump(own), **work.tables}
    if settings:
        texts[PHOTOGRAPHS] = dump(settings)
    with _beside(out) as folder:
        for name, text in texts.items():
            _file(folder, name).write_text(text, encoding="utf-8")
        for name, path in work.copies.items():
            shutil.copyfile(path, _file(folder, name))
        if board is not None:
            (folder / BOARD).write_bytes(board)
        try:
            read(folder)
            read_photo_settings(folder)
        except InputError as error:
            raise InputError(_at_source(str(error), folder, work)) from None
        out.parent.mkdir(parents=True, exist_ok=True)
        if out.exists():
            out.rmdir()
        folder.rename(out)
    return Built(folder=out, experiment=read(out), defaults=tuple(work.defaults))


def _trial(
    work: Work, entry: CouponAnswers | PokeAnswers | BeamAnswers, materials: dict[str, dict[str, Any]]
) -> dict[str, Any]:
    where = entry.id
    material = work.settle(where, "material", entry.material, "name of the material", some_text)
    trial: dict[str, Any] = {"id": entry.id, "kind": entry.kind, "material": material}
    if entry.specimen is not None:
        trial["specimen"] = entry.specimen
    made: Made
    if isinstance(entry, CouponAnswers):
        keys, made = make_coupon(work, entry)
    elif isinstance(entry, PokeAnswers):
        keys, made = make_poke(work, entry)
    else:
        keys = make_beam(work, entry)
        given = materials.setdefault(material, {})
        if "density_sd_kg_m3" not in given or "density_kg_m3" not in given:
            materials[material] = given = density(work, material, given)
        made = bar(keys, float(given["density_kg_m3"]))
    for check in CHECKS:
        sentence = None if check.name in entry.accept else check.test(made)
        if sentence is not None:
            work.asker.confirm(where, check.name, sentence)
    return trial | keys


def _head(defaults: list[str]) -> str:
    lines = [f"# Made by calibration.new from {ANSWERS} beside it."]
    if defaults:
        lines.append("# Not stated by the lab, but taken by default or from the files' headers:")
        lines += [f"# - {' '.join(text.split())}" for text in defaults]
    return "\n".join(lines) + "\n"


def _key(text: str) -> str:
    """The key that a sentence on a default begins with; a sentence on something else as it is."""
    key, _, _ = text.partition(" ")
    return text if key.endswith(":") else key


def dump(content: dict[str, Any]) -> str:
    """YAML as it is written."""
    return str(yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=110))


def _plain(node: Any) -> Any:
    """Without tuples, which YAML has not."""
    if isinstance(node, dict):
        return {key: _plain(value) for key, value in node.items()}
    if isinstance(node, list | tuple):
        return [_plain(value) for value in node]
    return node


def _move_paths(node: Any, base: Path, names: dict[Path, str]) -> None:
    """Names of files in answers, as they are called in the experiment's folder."""
    if isinstance(node, list):
        for value in node:
            _move_paths(value, base, names)
    elif isinstance(node, dict):
        for key, value in node.items():
            if key in ("file", "photo", "outline", "markers", "points", "mesh") and isinstance(value, str):
                node[key] = names.get(base / value, value)
            else:
                _move_paths(value, base, names)


def _at_source(text: str, folder: Path, work: Work) -> str:
    """A sentence on the files of a folder that is not kept, on those that the lab has in their place."""
    for name in sorted(work.copies, key=len, reverse=True):  # one name may begin another
        text = text.replace(str(folder / name), str(work.copies[name]))
    return text.replace(str(folder / "experiment.yaml"), work.asker.place)


def _file(folder: Path, name: str) -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


@contextlib.contextmanager
def _beside(out: Path) -> Iterator[Path]:
    """A new folder on the same disk as `out`, removed again unless it was moved."""
    above = next(p for p in out.absolute().parents if p.is_dir())
    folder = Path(tempfile.mkdtemp(prefix=f".{out.name}-", dir=above))
    try:
        folder.chmod(0o755)
        yield folder
    finally:
        if folder.exists():
            shutil.rmtree(folder)
