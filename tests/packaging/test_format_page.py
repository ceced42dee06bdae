"""The page on the experiment format names every key that the reader accepts, and no other."""

from __future__ import annotations

import re
from typing import Any

import pydantic
import yaml

import calibration.experiment as experiment
from calibration.experiment._photographs import PhotoSettings
from tests.packaging.blocks import ROOT

DOCS = ROOT / "docs"
PAGE = (DOCS / "reference" / "experiment-format.md").read_text(encoding="utf-8")
PHOTOGRAPH_PAGE = (DOCS / "how-to" / "photograph.md").read_text(encoding="utf-8")


def models() -> set[type[pydantic.BaseModel]]:
    """All strict models into which experiment.yaml is read."""
    found: set[type[pydantic.BaseModel]] = set()
    waiting: list[type[pydantic.BaseModel]] = [experiment.Strict]
    while waiting:
        for child in waiting.pop().__subclasses__():
            if child.__module__.startswith("calibration.experiment") and child is not PhotoSettings:
                found.add(child)
            waiting.append(child)
    return found


def test_every_key_is_on_the_page() -> None:
    keys = {name for model in models() for name in model.model_fields}
    assert len(keys) > 40
    words = set(re.findall(r"[A-Za-z_]\w*", PAGE))
    assert keys <= words, sorted(keys - words)


def test_every_key_of_photographs_yaml_is_on_its_page() -> None:
    words = set(re.findall(r"[A-Za-z_]\w*", PHOTOGRAPH_PAGE))
    assert PhotoSettings.model_fields.keys() <= words, sorted(PhotoSettings.model_fields.keys() - words)


def test_the_page_shows_keys_that_exist() -> None:
    keys = {name for model in models() for name in model.model_fields}

    def used(value: Any) -> set[str]:
        if isinstance(value, dict):
            own = {k for k in value if not (isinstance(value[k], dict) and k[0].isupper())}
            return own.union(*(used(v) for v in value.values()), set())
        if isinstance(value, list):
            return set().union(*(used(v) for v in value))
        return set()

    shown: set[str] = set()
    for block in re.findall(r"^```yaml\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL):
        shown |= used(yaml.safe_load(re.sub(r"\{\.\.\.\}|\[\.\.\.\]", "0", block)))
    free = {"S0.5", "tip1"}  # names, not keys
    assert len(shown) > 30
    assert shown - free <= keys, sorted(shown - free - keys)
