"""Training: recipes, losses, checkpoints, the loop."""

from learn.training.checkpoint import Run, load_run
from learn.training.loop import DivergedError, Progress, Trainer
from learn.training.recipe import RECIPES, Recipe, load_recipe

__all__ = ["RECIPES", "DivergedError", "Progress", "Recipe", "Run", "Trainer", "load_recipe", "load_run"]
