"""Training: recipes, the loop, a run's folder."""

from learn.training.loop import DivergedError, Trainer
from learn.training.process_group import ProcessGroup, make_device, make_process_group
from learn.training.recipe import RECIPES, Recipe, load_recipe
from learn.training.run_dataset import check_dataset, known_domain, open_dataset, open_tables
from learn.training.run_folder import Run, load_run, read_log

__all__ = [
    "RECIPES",
    "DivergedError",
    "ProcessGroup",
    "Recipe",
    "Run",
    "Trainer",
    "check_dataset",
    "known_domain",
    "load_recipe",
    "load_run",
    "make_device",
    "make_process_group",
    "open_dataset",
    "open_tables",
    "read_log",
]
