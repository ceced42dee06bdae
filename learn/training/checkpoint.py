"""Checkpoints: written whole or not at all; they carry the dataset's uuid, the recipe and the statistics."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from learn.data.statistics import Statistics
from learn.data.store import Store
from learn.errors import InputError
from learn.models import VERSIONS, Model, make_model
from learn.training.recipe import Recipe, check_recipe

FORMAT = 1
LAST, BEST = "last.pt", "best.pt"


@dataclass(frozen=True, eq=False, kw_only=True)
class Run:
    """A trained model ready to use. uuid, law, location: of the dataset it was trained on.

    members: folders of the runs that were joined to this one, none of a plain run.
    """

    folder: Path
    recipe: Recipe
    statistics: Statistics
    uuid: str
    law: str
    location: str
    groups: dict[str, list[str]]
    epoch: int
    model: Model
    members: tuple[Path, ...] = ()


def save_checkpoint(path: Path, content: dict[str, Any]) -> None:
    """Writes beside, then puts in place: a kill leaves the old file or the new one."""
    beside = path.with_suffix(".part")
    torch.save({"format": FORMAT, **content}, beside)
    with beside.open("rb") as file:
        os.fsync(file.fileno())
    beside.replace(path)


def load_checkpoint(path: Path) -> dict[str, Any]:
    """A checkpoint's content; InputError where it is missing, damaged or of another format."""
    if not path.is_file():
        raise InputError(f"{path}: no such checkpoint")
    try:
        content: dict[str, Any] = torch.load(path, map_location="cpu", weights_only=True)
    except Exception as error:  # unpickling breaks in many ways
        text = " ".join(str(error).split())[:120]
        raise InputError(f"{path}: not a readable checkpoint ({text})") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise InputError(f"{path}: expected a checkpoint of format {FORMAT}")
    return content


def check_dataset(content: dict[str, Any], path: Path, store: Store) -> None:
    """InputError where a checkpoint was trained on another dataset."""
    if content["uuid"] != store.uuid:
        raise InputError(
            f"{path}: trained on dataset {content['uuid']}, but {store.location} is {store.uuid}"
        )


def check_version(content: dict[str, Any], path: Path) -> None:
    """InputError where a checkpoint is of another version of its model."""
    name, found = str(content["recipe"]["model"]), content.get("version", 1)
    now = VERSIONS.get(name, found)
    if found != now:
        raise InputError(
            f"{path}: weights of version {found} of model {name}, this is version {now}: train again"
        )


def load_run(folder: Path | str) -> Run:
    """The best model of a run's folder, in evaluation mode on the CPU."""
    path = Path(folder) / BEST
    content = load_checkpoint(path)
    check_version(content, path)
    statistics = Statistics(**content["statistics"])
    recipe = check_recipe(content["recipe"], str(path))
    model = make_model(recipe.model, statistics)
    try:
        model.load_state_dict(content["model"])
    except RuntimeError as error:
        raise InputError(
            f"{path}: does not fit model {recipe.model} ({str(error).splitlines()[0]})"
        ) from None
    model.eval().requires_grad_(False)
    return Run(
        folder=Path(folder),
        recipe=recipe,
        statistics=statistics,
        uuid=content["uuid"],
        law=content["law"],
        location=content["location"],
        groups=content["groups"],
        epoch=content["epoch"],
        model=model,
    )
