"""Kinds of values in an experiment.yaml, and the strict model that they stand in."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from pathlib import PurePosixPath
from typing import Annotated, Any, ClassVar, Protocol

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from calibration._files import on_any_disk

# beyond these a number is a slip of the unit, not a specimen
_LONGEST_MM = 1e5
_UNITS = ("_kg_m3", "_m_s2", "_kPa", "_mm", "_deg", "_s", "_N", "_sd")


class KnownKeys(BaseModel):
    """Refuses unknown keys with the key that was meant, NaN and infinity."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    may_be_empty: ClassVar[bool] = True  # keys without a value

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        # before pydantic's own check, since only here it is known which keys were expected
        if isinstance(data, dict):
            unknown = [str(key) for key in data if key not in cls.model_fields]
            if unknown:
                known = list(cls.model_fields)
                meant = [expected_key(key, known) for key in unknown]
                also = "".join(
                    f"; also unknown: {key[:60]} (expected {name})"
                    for key, name in list(zip(unknown, meant, strict=True))[1:4]
                )
                missing = [
                    name
                    for name, field in cls.model_fields.items()
                    if field.is_required() and name not in data and name not in meant
                ]
                if missing:
                    also += f"; also missing: {', '.join(missing)}"
                raise PydanticCustomError(
                    "unknown_key",
                    "expected {expected}",
                    {"key": unknown[0], "expected": meant[0], "also": also},
                )
            for key, value in data.items():
                if value is None and not cls.may_be_empty:
                    raise PydanticCustomError(
                        "no_value", "expected a value, or the key left out", {"key": str(key)}
                    )
        return data


class Strict(KnownKeys):
    """Base of an experiment's files: unknown keys, keys without a value, NaN and infinity are refused."""

    model_config = ConfigDict(strict=True)
    may_be_empty = False


def expected_key(key: str, known: list[str]) -> str:
    """Suggestion for an unknown key.

    It is the same quantity in the unit of the format, else the key nearest in spelling, else all known keys.
    """
    stem = _stem(key)
    for name in known:
        if _stem(name) == stem:
            return name
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.75)
    return near[0] if near else f"one of {', '.join(known)}"


def _stem(key: str) -> str:
    """radius_sd of radius_sd_mm and of radius_sd_m."""
    for unit in _UNITS[:-1]:
        if key.endswith(unit):
            return key.removesuffix(unit).lower()
    head, _, tail = key.rpartition("_")
    return (head if head and tail != "sd" and len(tail) <= 3 else key).lower()


def say(key: str, text: str) -> PydanticCustomError:
    """The error of a model's own check, laid to one of its keys (dots lead deeper)."""
    return PydanticCustomError("own_check", "{text}", {"key": key, "text": text})


def _inside(suffixes: tuple[str, ...]) -> AfterValidator:
    def check(name: str) -> str:
        path = PurePosixPath(name)
        if not name.isprintable() or len(name) > 300:
            raise PydanticCustomError("path", "expected a path of at most 300 printable characters")
        if path.is_absolute() or "\\" in name or ":" in name or ".." in path.parts:
            raise PydanticCustomError(
                "path",
                "expected a path inside the experiment's folder, relative to it, got {name}",
                {"name": repr(name)},
            )
        if path.suffix.lower() not in suffixes:
            raise PydanticCustomError(
                "path",
                "expected a file {suffixes}, got {name}",
                {"suffixes": " or ".join(suffixes), "name": repr(name)},
            )
        return str(path)

    return AfterValidator(check)


Length = Annotated[float, Field(gt=0, le=_LONGEST_MM)]
Coordinate = Annotated[float, Field(ge=-_LONGEST_MM, le=_LONGEST_MM)]
Position = tuple[Coordinate, Coordinate, Coordinate]
Component = Annotated[float, Field(ge=-1e6, le=1e6)]
Numbers3 = tuple[Component, Component, Component]
# of a nominal value: 0 where the lab takes it for exact
Doubt = Annotated[float, Field(ge=0, le=_LONGEST_MM)]
# of a measurement: never exact
Noise = Annotated[float, Field(gt=0, le=_LONGEST_MM)]
Name = Annotated[str, Field(pattern=r"^\w[\w .,+()%-]*$", max_length=100)]
CsvFile = Annotated[str, _inside((".csv",))]
MeshFile = Annotated[str, _inside((".stl", ".obj", ".ply"))]
PhotoFile = Annotated[str, _inside((".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp"))]


class CircleSection(Strict):
    """A circular section."""

    radius_mm: Length
    radius_sd_mm: Doubt = 0.0

    @model_validator(mode="after")
    def _doubt(self) -> CircleSection:
        below("radius_sd_mm", self.radius_sd_mm, "radius_mm", self.radius_mm)
        return self


class RectangleSection(Strict):
    """A rectangular section, width along y, height along z."""

    width_mm: Length
    height_mm: Length
    width_sd_mm: Doubt = 0.0
    height_sd_mm: Doubt = 0.0

    @model_validator(mode="after")
    def _doubt(self) -> RectangleSection:
        below("width_sd_mm", self.width_sd_mm, "width_mm", self.width_mm)
        below("height_sd_mm", self.height_sd_mm, "height_mm", self.height_mm)
        return self


def metres(point_mm: Position) -> tuple[float, float, float]:
    """A point or vector of a file [mm] in SI."""
    return (point_mm[0] * 1e-3, point_mm[1] * 1e-3, point_mm[2] * 1e-3)


def below(key: str, value: float, limit_key: str, limit: float) -> None:
    """Refuses a standard deviation as large as what it belongs to."""
    if value >= limit:
        raise say(key, f"expected less than {limit_key} = {limit:g}, got {value:g}")


class Identified(Protocol):
    """An entry of a trial."""

    @property
    def id(self) -> str: ...


def different_ids(trials: Sequence[Identified]) -> None:
    """Refuses two trials of one id, or of ids that differ in letter case alone: they name files."""
    seen: dict[str, str] = {}
    for k, trial in enumerate(trials, 1):
        other = seen.setdefault(on_any_disk(trial.id), trial.id)
        if len(seen) == k:
            continue
        if other == trial.id:
            raise say("trials", f"expected different ids, trial #{k} has the id {trial.id} again")
        raise say(
            "trials",
            f"expected ids that differ in more than letter case, trial #{k} has the id {trial.id}, another"
            f" {other}",
        )


def different_materials(names: Iterable[str]) -> None:
    """Refuses materials whose names differ in letter case alone: they name cards."""
    seen: dict[str, str] = {}
    for name in names:
        other = seen.setdefault(on_any_disk(name), name)
        if other != name:
            raise say(
                "materials", f"expected names that differ in more than letter case, got {other} and {name}"
            )


def only_one(**given: object) -> None:
    """Refuses all but exactly one of the keys."""
    if sum(value is not None for value in given.values()) != 1:
        raise PydanticCustomError("one_of", "expected exactly one of {keys}", {"keys": ", ".join(given)})
