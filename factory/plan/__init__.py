"""Plans: every poke of a recipe under one law, drawn, and the solves that pokes share."""

from factory.plan.dataset import FORMAT, Plan, changes, make_plan, versions

__all__ = ["FORMAT", "Plan", "changes", "make_plan", "versions"]
