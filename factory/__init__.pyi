from ._build import BuildProgress, Built, build_dataset
from ._checks import Verification, verify_dataset
from ._errors import InputError
from ._planned import PlannedPoke
from ._poke_data import PokeData
from ._store import DamagedError
from ._summary import Summary, summarise
from .materials import Card, load_card, material_of
from .plan import Plan, make_plan
from .reader import Dataset, open_dataset
from .recipe import Recipe, Shape, load_recipe, recipe_names

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
