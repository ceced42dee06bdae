"""Datasets of simulated pokes: planned from a recipe, built, resumed, read and verified.

>>> import factory
>>> from pathlib import Path
>>> plan = factory.make_plan(factory.load_recipe("quick"), "ogden")
>>> plan
Plan(quick, ogden: 12 pokes = 2 shapes x 3 material levels x 2)
>>> built = factory.build_dataset(plan, Path("datasets/quick-ogden.zarr"))        # doctest: +SKIP
>>> factory.open_dataset("datasets/quick-ogden.zarr").poke(3).rod_force           # doctest: +SKIP

The commands are `python -m factory.build`, `.inspect`, `.verify`, `.card` and `.release`. `build_dataset`
takes a callback `on_progress`; what happens besides is logged under "factory". Errors that people
can act on are `InputError`.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from factory._build import BuildProgress, Built, build_dataset
    from factory._checks import Verification, verify_dataset
    from factory._input import InputError
    from factory._store import DamagedError
    from factory._summary import Summary, summarise
    from factory.materials import Card, load_card, material_of
    from factory.plan import Plan, PlannedPoke, make_plan
    from factory.reader import Dataset, PokeData, open_dataset
    from factory.recipe import Recipe, Shape, load_recipe, recipe_names

# imported when first asked for: a command's --help needs none of them
_WHERE = {
    "BuildProgress": "_build",
    "Built": "_build",
    "Card": "materials",
    "DamagedError": "_store",
    "Dataset": "reader",
    "InputError": "_input",
    "Plan": "plan",
    "PlannedPoke": "plan",
    "PokeData": "reader",
    "Recipe": "recipe",
    "Shape": "recipe",
    "Summary": "_summary",
    "Verification": "_checks",
    "build_dataset": "_build",
    "load_card": "materials",
    "load_recipe": "recipe",
    "make_plan": "plan",
    "material_of": "materials",
    "open_dataset": "reader",
    "recipe_names": "recipe",
    "summarise": "_summary",
    "verify_dataset": "_checks",
}

__all__ = [
    "BuildProgress",
    "Built",
    "Card",
    "DamagedError",
    "Dataset",
    "InputError",
    "Plan",
    "PlannedPoke",
    "PokeData",
    "Recipe",
    "Shape",
    "Summary",
    "Verification",
    "build_dataset",
    "load_card",
    "load_recipe",
    "make_plan",
    "material_of",
    "open_dataset",
    "recipe_names",
    "summarise",
    "verify_dataset",
]


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module 'factory' has no attribute {name!r}")
    return getattr(importlib.import_module(f"factory.{_WHERE[name]}"), name)


def __dir__() -> list[str]:
    return __all__
