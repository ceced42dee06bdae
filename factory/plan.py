"""From a recipe to the list of its pokes: every site, direction and inclusion drawn from the seed."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import math
import uuid
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from factory._extended import in_one_law
from factory.errors import InputError
from factory.materials import Card, card_path, check_law, load_card, material_of
from factory.recipe import Cube, Cylinder, Recipe, Sphere
from tisim.bodies import Block, BoxInclusion, CylinderInclusion, Inclusion, Rod, SphereInclusion
from tisim.scene import Material, Poke

FORMAT = 1  # of the store; raised whenever its arrays change meaning
_NAMESPACE = uuid.UUID("6f2b1d0e-6f0b-5c1a-9d53-0a4c7f1b8e21")
_MM = 1e-3


@dataclass(frozen=True, kw_only=True)
class PlannedPoke:
    """One poke to simulate; indices into the plan's shapes and softness levels.

    geometry: shape * number of softness levels + softness. site: number of the site within its set.
    shared: the site is common to all softness levels of the shape. seed: what the site was drawn from.
    """

    index: int
    shape: int
    softness: int
    geometry: int
    site: int
    shared: bool
    seed: int
    scene: Poke


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A whole dataset before it is simulated; `identity` is what its bytes depend on.

    model: the law that was asked for.
    """

    recipe: Recipe
    model: str
    cards: tuple[Card, ...]
    materials: tuple[Material, ...]
    inclusions: tuple[Inclusion, ...]
    pokes: tuple[PlannedPoke, ...]
    identity: dict[str, Any]

    @property
    def fingerprint(self) -> str:
        """sha256 of the identity."""
        text = json.dumps(self.identity, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()

    @property
    def uuid(self) -> str:
        """The dataset's uuid: the same recipe, materials and versions give the same one."""
        return str(uuid.uuid5(_NAMESPACE, self.fingerprint))

    @property
    def law(self) -> str:
        """The law of all materials: the model, but for what effects make of it."""
        return self.materials[0].law

    @property
    def block(self) -> tuple[float, float, float]:
        """Size of the block [m]."""
        return self.pokes[0].scene.block.size


def make_plan(recipe: Recipe, model: str, materials: Path | None = None) -> Plan:
    """All pokes of a recipe under one law, in the order they are stored: shape, softness, shared, own."""
    check_law(model)
    cards = tuple(load_card(name, materials) for name in recipe.softness)
    laws = _materials(cards, model, materials)
    inclusions = tuple(_place(recipe, number) for number in range(len(recipe.shapes)))
    pokes: list[PlannedPoke] = []
    for shape, inclusion in enumerate(inclusions):
        for softness, material in enumerate(laws):
            for site in range(recipe.pokes_each):
                shared = site < recipe.protocol.shared_sites
                key = (shape, 0, site) if shared else (shape, 1 + softness, site)
                seed = _seed(recipe.seed, key)
                pokes.append(
                    PlannedPoke(
                        index=len(pokes),
                        shape=shape,
                        softness=softness,
                        geometry=shape * len(laws) + softness,
                        site=site,
                        shared=shared,
                        seed=seed,
                        scene=_scene(recipe, inclusion, material, seed),
                    )
                )
    identity = {
        "format": FORMAT,
        "model": model,
        "recipe": recipe.model_dump(mode="json"),
        "materials": {
            name: {**asdict(material), "stiffness": card.stiffness, **_taken(card)}
            for name, material, card in zip(recipe.softness, laws, cards, strict=True)
        },
        "versions": versions(),
    }
    return Plan(
        recipe=recipe,
        model=model,
        cards=cards,
        materials=laws,
        inclusions=inclusions,
        pokes=tuple(pokes),
        identity=json.loads(json.dumps(identity)),  # as it will be read back: lists for tuples
    )


def _materials(cards: Sequence[Card], model: str, folder: Path | None) -> tuple[Material, ...]:
    """The materials of the cards, all in one law, with what their effects make of them."""
    found: dict[str, Material] = {}
    for card in cards:
        try:
            found[card.material] = material_of(card, model)
        except InputError as error:
            raise InputError(f"{card_path(card.material, folder)}: {error}") from None
    return tuple(in_one_law(found).values())


def _taken(card: Card) -> dict[str, Any]:
    """The effects that a dataset takes over from a card; no key where there are none."""
    taken = [e.model_dump(mode="json") for e in card.effects if not e.left_out(card.material)]
    return {"effects": taken} if taken else {}


def versions() -> dict[str, str]:
    """Versions that the numbers depend on."""
    found: dict[str, str] = {}
    for package in ("tisim", "numpy", "zarr", "numcodecs"):
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            found[package] = "source"  # run from a checkout that was not installed
    return found


def differences(old: object, new: object, prefix: str = "") -> list[str]:
    """Dotted keys under which two identities differ."""
    if isinstance(old, dict) and isinstance(new, dict):
        found: list[str] = []
        for key in sorted({*old, *new}):
            found += differences(old.get(key), new.get(key), f"{prefix}.{key}" if prefix else str(key))
        return found
    return [] if old == new else [prefix]


def changes(old: object, new: object) -> str:
    """What differs between two identities, in few words; another model also changes the materials."""
    keys = differences(old, new)
    if "model" in keys:
        return "model"
    order = ("recipe", "materials", "versions", "format")
    keys.sort(key=lambda key: order.index(key.split(".")[0]) if key.split(".")[0] in order else len(order))
    return ", ".join(keys[:3]) + (f" and {len(keys) - 3} more" if len(keys) > 3 else "")


def _seed(root: int, key: Iterable[int]) -> int:
    state = np.random.SeedSequence(entropy=root, spawn_key=tuple(key))
    return int(state.generate_state(1, np.uint64)[0])


def _place(recipe: Recipe, number: int) -> Inclusion:
    """The inclusion of one shape at a random place of the base, `border_mm` away from the sides."""
    shape = recipe.shapes[number]
    random = np.random.default_rng(_seed(recipe.seed, (number, 2**32 - 1)))
    room = [side / 2 - recipe.border_mm - shape.reach_mm for side in recipe.block_mm[:2]]
    x, y = (float(v) * _MM for v in random.uniform(-1, 1, 2) * room)
    if isinstance(shape, Cube):
        side = shape.side_mm * _MM
        angle = float(random.uniform(0, math.pi / 2))
        return BoxInclusion(size=(side, side, side), centre=(x, y, side / 2), angle=angle)
    if isinstance(shape, Sphere):
        z = (shape.radius_mm - shape.sunk_mm) * _MM
        return SphereInclusion(radius=shape.radius_mm * _MM, centre=(x, y, z))
    assert isinstance(shape, Cylinder)
    height = shape.height_mm * _MM
    return CylinderInclusion(radius=shape.radius_mm * _MM, height=height, centre=(x, y, height / 2))


def _scene(recipe: Recipe, inclusion: Inclusion, material: Material, seed: int) -> Poke:
    """The poke that a seed draws: a site on the top, an angle to the normal and a heading."""
    protocol = recipe.protocol
    random = np.random.default_rng(seed)
    room = [side / 2 - protocol.margin_mm for side in recipe.block_mm[:2]]
    x, y = (float(v) * _MM for v in random.uniform(-1, 1, 2) * room)
    angle = math.radians(float(random.uniform(0, protocol.max_angle_deg)))
    heading = float(random.uniform(0, 2 * math.pi))
    sine = math.sin(angle)
    width, length, height = (side * _MM for side in recipe.block_mm)
    return Poke(
        material=material,
        site=(x, y),
        direction=(sine * math.cos(heading), sine * math.sin(heading), -math.cos(angle)),
        depth=protocol.depth_mm * _MM,
        block=Block(size=(width, length, height), inclusion=inclusion),
        rod=Rod(
            radius=recipe.rod.radius_mm * _MM,
            length=recipe.rod.length_mm * _MM,
            tip=recipe.rod.tip,
            edge_radius=recipe.rod.edge_radius_mm * _MM,
        ),
        friction=recipe.friction,
        frame_spacing=protocol.frame_spacing_mm * _MM,
        refinement=recipe.refinement,
    )
