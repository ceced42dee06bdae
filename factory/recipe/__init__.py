"""Recipes: what a dataset contains, as YAML states it: shapes, contact points, courses."""

from factory.recipe.model import Protocol, Recipe, RodRecipe, Shape, load_recipe, recipe_names

__all__ = ["Protocol", "Recipe", "RodRecipe", "Shape", "load_recipe", "recipe_names"]
