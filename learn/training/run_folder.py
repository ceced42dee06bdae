"""A run's folder: checkpoints, written atomically, and the log.

`last.pt` holds everything that training needs to resume; `best.pt` the weights of the best epoch on the
validation part. Both carry the dataset's uuid, the recipe, the statistics and the domain of validity.
`log.jsonl` has a line of JSON per epoch; TensorBoard events are added if tensorboardX is installed.
`dataset.npz` has the dataset's small tables (`learn.training.run_dataset`).
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import hashlib
import importlib
import io
import json
import os
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import torch
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from learn._yaml import Finite, first_fault
from learn.data.statistics import Statistics
from learn.errors import InputError
from learn.models import MODELS, Model, make_model
from learn.pretrained import folder_of
from learn.training.recipe import Recipe, check_recipe
from learn.validity import Domain

FORMAT = 1
LAST, BEST, LOG = "last.pt", "best.pt", "log.jsonl"


@dataclass(frozen=True, eq=False, kw_only=True)
class Pretrained:
    """The run that an adapted run was begun from; attributes as those of `Run`."""

    folder: Path
    recipe: Recipe
    uuid: str
    location: str
    groups: dict[str, list[str]]
    seen: frozenset[str]


@dataclass(frozen=True, eq=False, kw_only=True)
class Run:
    """A trained model ready to use.

    Attributes
    ----------
    folder : folder of the run.
    recipe, statistics : recipe and statistics that it was trained with.
    uuid, law, location : identifier, law and location of the training dataset.
    groups : shapes or sites of the parts "train", "validation" and "test".
    seen : keys of the contact points of the first two (`learn.data.contact_points`); empty for runs trained
        before they were recorded.
    epoch : the epoch that was kept, counted from 1.
    model : the model in evaluation mode, on the CPU.
    weights : sha256 of the file that the model was read from, or of each member's: the folder may hold others
        by now, if the run is still trained.
    domain : domain of validity; None for runs trained before it was recorded (see `known_domain`).
    members : folders of the runs that were joined to this one as an ensemble; empty for one run.
    pretrained : the run that this one was adapted from (`learn.adaptation`); None for one trained from the
        start.
    """

    folder: Path
    recipe: Recipe
    statistics: Statistics
    uuid: str
    law: str
    location: str
    groups: dict[str, list[str]]
    seen: frozenset[str]
    epoch: int
    model: Model
    weights: tuple[str, ...]
    domain: Domain | None = None
    members: tuple[Path, ...] = ()
    pretrained: Pretrained | None = None


class _Statistics(BaseModel):
    model_config = ConfigDict(extra="forbid")
    frames: Annotated[int, Field(ge=1)]
    displacement: Finite
    depth_mean: Finite
    depth_max: Finite
    log_force_mean: Finite
    log_force_sd: Finite
    force_rms: Finite
    log_modulus_mean: Finite | None = None
    block_height: Annotated[Finite, Field(gt=0)] | None = None
    log_time_mean: Finite | None = None
    log_speed_mean: Finite | None = None


class _Pretrained(BaseModel):
    model_config = ConfigDict(extra="forbid")
    folder: str
    recipe: dict[str, Any]
    uuid: str
    location: str
    groups: dict[str, list[str]]
    seen: list[str]
    weights: str  # sha256 of its best.pt


class _Content(BaseModel):
    """Content of every checkpoint; `last.pt` holds more (`_Resumable`)."""

    model_config = ConfigDict(arbitrary_types_allowed=True)
    version: Annotated[int, Field(strict=True)] = 1
    uuid: str
    law: str
    location: str
    recipe: dict[str, Any]
    statistics: _Statistics
    groups: dict[str, list[str]]
    seen: list[str] = []
    epoch: Annotated[int, Field(strict=True, ge=0)]
    model: dict[str, torch.Tensor]
    domain: dict[str, Any] | None = None
    pretrained: _Pretrained | None = None


class _Resumable(_Content):
    averaged: dict[str, torch.Tensor]
    optimiser: dict[str, Any]
    random: torch.Tensor | None = None  # in checkpoints of before 2026-11-27
    step: Annotated[int, Field(strict=True, ge=0)]
    best: Annotated[float, Field(strict=True)]
    first: Annotated[float, Field(strict=True)]


def save_checkpoint(path: Path, content: dict[str, Any]) -> None:
    """Write a checkpoint atomically: a kill or a full disk leaves the old file or the new one.

    Raises
    ------
    OSError
        If it cannot be written; the old file is kept.
    """
    buffer = io.BytesIO()
    torch.save({"format": FORMAT, **content}, buffer)
    write_whole(path, buffer.getvalue())


def write_whole(path: Path, data: bytes) -> None:
    """Write a file atomically: it holds these bytes, or its earlier content. OSError if it cannot be."""
    if path.is_dir():  # "." has no name to derive another from
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    # under a name drawn for it, as `tisim.io.whole` has it: two processes never write into the same one
    beside = path.with_name(f"{path.name}.{secrets.token_hex(4)}.part")
    try:
        with beside.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except BaseException as error:
        with contextlib.suppress(OSError):  # which would hide the error itself
            beside.unlink()
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(path)) from None
        raise


def load_checkpoint(path: Path) -> dict[str, Any]:
    """A checkpoint's content; InputError if it is missing, damaged or of another format."""
    return _content_of(_bytes_of(path), path)


def _bytes_of(path: Path) -> bytes:
    if not path.is_file():
        raise InputError(f"{path}: no such checkpoint")
    return path.read_bytes()


def _content_of(data: bytes, path: Path) -> dict[str, Any]:
    try:
        content: dict[str, Any] = torch.load(io.BytesIO(data), map_location="cpu", weights_only=True)
    except Exception as error:  # unpickling breaks in many ways
        text = " ".join(str(error).split())[:120]
        raise InputError(f"{path}: not a readable checkpoint ({text})") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise InputError(f"{path}: expected a checkpoint of format {FORMAT}")
    kind = _Resumable if path.name == LAST else _Content
    try:
        kind.model_validate(content)
    except ValidationError as error:
        raise InputError(f"{path}: not a readable checkpoint ({first_fault(error)})") from None
    return content


def recipe_of(content: dict[str, Any], path: Path) -> Recipe:
    """A checkpoint's recipe; InputError if it is damaged, or its model is of another version."""
    recipe = check_recipe(content["recipe"], str(path))
    found, now = content.get("version", 1), MODELS[recipe.model].version
    if found != now:
        raise InputError(
            f"{path}: weights of version {found} of model {recipe.model}, this is version {now}: train again"
        )
    return recipe


def load_weights(model: Model, weights: dict[str, torch.Tensor], path: Path, name: str) -> None:
    """Load weights into the model; InputError if they do not fit it or are not finite."""
    try:
        model.load_state_dict(weights)
    except RuntimeError as error:
        raise InputError(f"{path}: does not fit model {name} ({str(error).splitlines()[0]})") from None
    for key, value in weights.items():
        if not bool(torch.isfinite(value).all()):
            raise InputError(f"{path}: weight {key} has a value that is not finite")


def load_run(folder: Path | str) -> Run:
    """Load the best model of a run's folder, or of the network of this name that comes with the package.

    InputError if there is none, or it is damaged.
    """
    folder = folder_of(folder)
    path = folder / BEST
    data = _bytes_of(path)
    content = _content_of(data, path)
    recipe = recipe_of(content, path)
    statistics = Statistics(**content["statistics"])
    model = make_model(recipe.model, statistics)
    load_weights(model, content["model"], path, recipe.model)
    model.eval().requires_grad_(False)
    domain = content.get("domain")
    return Run(
        folder=folder,
        recipe=recipe,
        statistics=statistics,
        uuid=content["uuid"],
        law=content["law"],
        location=content["location"],
        groups=content["groups"],
        seen=frozenset(content.get("seen", ())),
        epoch=content["epoch"],
        model=model,
        weights=(hashlib.sha256(data).hexdigest(),),
        domain=None if domain is None else Domain.from_dict(domain, str(path)),
        pretrained=_pretrained(content, path),
    )


def _pretrained(content: dict[str, Any], path: Path) -> Pretrained | None:
    about = content.get("pretrained")
    if about is None:
        return None
    return Pretrained(
        folder=Path(about["folder"]),
        recipe=check_recipe(about["recipe"], str(path)),
        uuid=about["uuid"],
        location=about["location"],
        groups=about["groups"],
        seen=frozenset(about["seen"]),
    )


def check_free(folder: Path) -> None:
    """Raise InputError if there is a run in the folder already, or it is a file."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: expected the name of a folder, this is a file")
    for name in (LAST, BEST):
        if (folder / name).exists():
            raise InputError(f"{folder}: a run is there already; choose another --out")


class Log:
    """Log of a run, RUN/log.jsonl. On resuming, lines of epochs to be trained again are dropped.

    While it is open, no other process can open it: two trainings would overwrite each other's checkpoints.
    InputError if another one has it, or has trained here since `epochs_done` was read.
    """

    def __init__(self, folder: Path, *, epochs_done: int) -> None:
        self._path, self._lock = folder / LOG, _locked(folder)
        try:
            last = folder / LAST
            if (load_checkpoint(last)["epoch"] if last.is_file() else 0) != epochs_done:
                raise InputError(
                    f"{last}: another training has written it in the meantime: --resume goes on, or choose"
                    " another --out"
                )
            _remove_parts(folder)
            kept = [line for line in read_log(folder) if line["epoch"] < epochs_done]
            write_whole(self._path, "".join(json.dumps(line) + "\n" for line in kept).encode())
        except BaseException:
            os.close(self._lock)
            raise
        try:
            module = importlib.import_module("tensorboardX")
        except ImportError:
            self._board: Any = None
        else:
            self._board = module.SummaryWriter(str(folder / "tensorboard"), purge_step=epochs_done)

    def add(self, line: dict[str, Any]) -> None:
        """Append one epoch's line."""
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        if self._board is not None:
            for key, value in line.items():
                if key != "epoch":
                    self._board.add_scalar(key, value, line["epoch"])

    def close(self) -> None:
        """Flush and close TensorBoard, and let others train here."""
        os.close(self._lock)
        if self._board is not None:
            with contextlib.suppress(OSError):  # a full disk was reported already
                self._board.close()


def _remove_parts(folder: Path) -> None:
    """Remove what killed trainings left of files that they were writing; needs the lock on the folder."""
    for name in (LAST, BEST, LOG):
        earlier = (folder / name).with_suffix(".part")  # the name before 2026-11-28
        for part in (earlier, *folder.glob(f"{name}.*.part")):
            with contextlib.suppress(OSError):  # then it stays, and harms nothing
                part.unlink()


def _locked(folder: Path) -> int:
    """A lock on the folder, which ends with the process or when it is closed."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise InputError(f"{folder}: another training is at work in it: choose another --out") from None
    return handle


def read_log(folder: Path) -> list[dict[str, Any]]:
    """Valid lines of the log, up to the first damaged one: a kill can truncate the last."""
    path = folder / LOG
    if not path.is_file():
        return []
    lines = []
    for text in path.read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            line = json.loads(text)
        except ValueError:
            break
        if not isinstance(line, dict) or not isinstance(line.get("epoch"), int):
            break
        lines.append(line)
    return lines
