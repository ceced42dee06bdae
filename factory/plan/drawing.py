"""Draw the scenes of a recipe: positions of the shapes, contact points, directions and courses.

Each shape's position and each poke has its own seed, made from the recipe's seed and the numbers of the
shape, the material level and the contact point: none depends on the draws of another.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from factory.errors import InputError
from factory.recipe.course import deepest, draw_course
from factory.recipe.model import Recipe
from factory.sampling import level_depths
from tisim import Block, Inclusion, Material, Poke
from tisim.problems import check_scene
from tisim.problems.indentation.kind import leaves

_MM = 1e-3
_DRAWS = 1000  # attempts to find a contact point above an inclusion


def seed_of(root: int, key: Iterable[int]) -> int:
    """Seed of one draw from the recipe's seed and the draw's key."""
    state = np.random.SeedSequence(entropy=root, spawn_key=tuple(key))
    return int(state.generate_state(1, np.uint64)[0])


def inclusion_of(recipe: Recipe, number: int) -> Inclusion:
    """Inclusion of one shape at its position on the base."""
    shape = recipe.shapes[number]
    return shape.standing(*_position(recipe, number))


def _position(recipe: Recipe, number: int) -> tuple[float, float, float]:
    """Position of a shape on the base [mm], `border_mm` or more from the sides, and its rotation [rad]."""
    shape = recipe.shapes[number]
    random = np.random.default_rng(seed_of(recipe.seed, (number, 2**32 - 1)))
    room = [side / 2 - recipe.border_mm - shape.reach_mm for side in recipe.block_of(shape)[:2]]
    x, y = (float(v) for v in random.uniform(-1, 1, 2) * room)
    return x, y, float(random.uniform(0, math.pi / 2)) if shape.turned else 0.0


def block_size(recipe: Recipe, number: int) -> tuple[float, float, float]:
    """Size of the block of one shape [m]."""
    width, length, height = (side * _MM for side in recipe.block_of(recipe.shapes[number]))
    return width, length, height


def _site(
    recipe: Recipe, number: int, inclusion: Inclusion, random: np.random.Generator, *, over: bool
) -> tuple[float, float]:
    """Draw a contact point [m] on the top face, or on that part of it which is right above the inclusion."""
    shape, margin = recipe.shapes[number], recipe.protocol.margin_mm
    room = np.array([side / 2 - margin for side in recipe.block_of(shape)[:2]])
    if not over:
        x, y = (float(v) * _MM for v in random.uniform(-1, 1, 2) * room)
        return x, y
    centre = np.array(_position(recipe, number)[:2])
    low, high = np.maximum(-room, centre - shape.reach_mm), np.minimum(room, centre + shape.reach_mm)
    column = level_depths(block_size(recipe, number)[2])
    for _ in range(_DRAWS if (low < high).all() else 0):
        x, y = (float(v) * _MM for v in random.uniform(low, high))
        points = np.stack([np.full_like(column, x), np.full_like(column, y), column], axis=1)
        if inclusion.contains(points).any():
            return x, y
    raise InputError(
        f"recipe {recipe.name}: protocol.over_inclusion: found no contact point above {shape.id} that is "
        f"margin_mm = {margin:g} or more from the edges: expected a larger border_mm or a smaller margin_mm"
    )


def draw_scene(
    recipe: Recipe, number: int, inclusion: Inclusion, material: Material, seed: int, *, over: bool
) -> Poke:
    """Draw a poke of a shape from a seed: contact point, angle to the normal, heading and course."""
    protocol = recipe.protocol
    random = np.random.default_rng(seed)
    x, y = _site(recipe, number, inclusion, random, over=over)
    angle = math.radians(float(random.uniform(0, protocol.max_angle_deg)))
    heading = float(random.uniform(0, 2 * math.pi))
    sine = math.sin(angle)
    driven: dict[str, Any] = {
        "depth": protocol.depth_mm * _MM,
        "frame_spacing": protocol.frame_spacing_mm * _MM,
    }
    if protocol.course:
        driven = {"course": draw_course(protocol.course, protocol.frame_spacing_mm, random)}
    return Poke(
        material=material,
        site=(x, y),
        direction=(sine * math.cos(heading), sine * math.sin(heading), -math.cos(angle)),
        block=Block(size=block_size(recipe, number), inclusion=inclusion),
        rod=recipe.rod.rod,
        friction=recipe.friction,
        refinement=recipe.refinement,
        **driven,
    )


def check_drawn(recipe: Recipe, number: int, index: int, poke: Poke) -> None:
    """Refuse what the solver would refuse, before hours of others are solved."""
    _check_path(recipe, number, index, poke)
    try:
        check_scene(index, poke)
    except ValueError as error:
        reason = str(error).removeprefix(f"scene {index}: ")
        raise InputError(f"recipe {recipe.name}: poke {index}: {reason}") from None


def _check_path(recipe: Recipe, number: int, index: int, poke: Poke) -> None:
    """Refuse a poke whose indenter, at its full depth, has left the block through a side."""
    end = leaves(poke, poke.direction, deepest(poke))
    if end is not None:
        protocol, shape = recipe.protocol, recipe.shapes[number]
        whose = str(index) if shape.block_mm is None else f"{index} in the block of {shape.id}"
        raise InputError(
            f"recipe {recipe.name}: protocol.margin_mm: expected contact points so far inside that no"
            f" indenter leaves the block through a side at up to {protocol.max_angle_deg:g} degrees and"
            f" {protocol.depth_mm:g} mm of depth, got {protocol.margin_mm:g}: that of poke {whose} ends at"
            f" x = {end[0] / _MM:.3g}, y = {end[1] / _MM:.3g} mm"
        )
