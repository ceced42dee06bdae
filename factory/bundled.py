"""Recipes and material cards that come with the package.

Separate from the code that reads them, so that `factory.build --help`, which names them, starts quickly.
"""

from __future__ import annotations

import importlib.resources
from pathlib import Path


def shipped_folder(name: str) -> Path:
    """Folder of the recipes or material cards that come with the package.

    Parameters
    ----------
    name : {"recipes", "materials"}

    Returns
    -------
    Path
        `factory/_shipped/NAME` of an installed wheel, `datasets/NAME` of a checkout.
    """
    installed = Path(str(importlib.resources.files("factory"))) / "_shipped" / name
    return installed if installed.is_dir() else Path(__file__).parent.parent / "datasets" / name


def recipe_names() -> list[str]:
    """Names of the recipes that come with the package."""
    return sorted(path.stem for path in shipped_folder("recipes").glob("*.yaml"))
