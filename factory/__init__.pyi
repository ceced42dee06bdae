from .building.build import BuildProgress, Built, build_dataset
from .bundled import recipe_names
from .checks.verification import Verification, verify_dataset
from .errors import InputError
from .inspection.summary import Summary, summarise
from .materials.cards import Card, load_card, material_of
from .plan.dataset import Plan, make_plan
from .plan.poke import PlannedPoke
from .reader import Dataset, open_dataset
from .recipe.model import Recipe, load_recipe
from .recipe.shapes import Shape
from .store.files import DamagedError
from .store.poke_data import PokeData

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
