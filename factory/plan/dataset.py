"""Plan a dataset: the pokes of a recipe under one law, the solves they share, and the dataset's identity."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import logging
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from factory.errors import InputError
from factory.materials.cards import (
    Card,
    card_names,
    card_path,
    check_law,
    load_card,
    material_of,
)
from factory.materials.effects import in_one_law
from factory.materials.parts import part_entries
from factory.plan.drawing import block_size, check_drawn, draw_scene, inclusion_of, seed_of
from factory.plan.poke import PlannedPoke
from factory.plan.shared_solves import one_solve
from factory.recipe.model import Recipe
from tisim import Inclusion, Material, parts
from tisim.laws import added
from tisim.mesh.indentation import LAYOUT
from tisim.parallel.extensions import digest_of_code, is_own
from tisim.problems.indentation.kind import CONTACT, ELEMENT

log = logging.getLogger(__name__)

FORMAT = 1  # version of the store's format; raised whenever its arrays change meaning
_NAMESPACE = uuid.UUID("6f2b1d0e-6f0b-5c1a-9d53-0a4c7f1b8e21")


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A whole dataset before it is simulated.

    Attributes
    ----------
    recipe : Recipe
    model : str
        The requested law.
    cards : tuple of Card
    materials : tuple of Material
        One per material level, in the order of the cards.
    inclusions : tuple of Inclusion
        One per shape of the recipe.
    pokes : tuple of PlannedPoke
        Pokes in the order in which they are stored.
    identity : dict
        All input on which the bytes of the dataset depend.
    """

    recipe: Recipe
    model: str
    cards: tuple[Card, ...]
    materials: tuple[Material, ...]
    inclusions: tuple[Inclusion, ...]
    pokes: tuple[PlannedPoke, ...]
    identity: dict[str, Any]

    def __repr__(self) -> str:
        return (
            f"Plan({self.recipe.name}, {self.model}: {len(self.pokes)} pokes = {len(self.inclusions)} shapes "
            f"x {len(self.materials)} material levels x {self.recipe.pokes_each})"
        )

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
        """Law of all materials: `model`, or the law to which effects extend it."""
        return self.materials[0].law

    @property
    def blocks(self) -> tuple[tuple[float, float, float], ...]:
        """Size of the block of each geometry (shape x material level) [m]."""
        sizes = [block_size(self.recipe, number) for number in range(len(self.recipe.shapes))]
        return tuple(size for size in sizes for _ in self.materials)


def make_plan(
    recipe: Recipe, model: str, materials: Path | None = None, *, levels: Sequence[str] | None = None
) -> Plan:
    """Plan a dataset: all pokes of a recipe under one law.

    Parameters
    ----------
    recipe : Recipe
    model : str
        Name of a law of `tisim.laws`.
    materials : Path, optional
        Folder of material cards; default: those that come with the package.
    levels : sequence of str, optional
        Names of the cards to use as material levels in place of the recipe's. By default, if `materials` has
        none of the recipe's levels, all of its own cards are used.

    Returns
    -------
    Plan
        Pokes in the order shape, material level, shared contact points, own contact points.

    Raises
    ------
    InputError
        If the law is unknown, a card is missing, is invalid or does not fit the law or the recipe, an
        indenter would leave the block through a side, or tisim refuses a scene.
    """
    check_law(model)
    recipe = _with_levels(recipe, materials, levels)
    cards = tuple(_card(name, materials) for name in recipe.levels)
    laws = _materials(cards, model, materials)
    _check_clock(recipe, cards, materials)
    inclusions = tuple(inclusion_of(recipe, number) for number in range(len(recipe.shapes)))
    pokes: list[PlannedPoke] = []
    for shape, inclusion in enumerate(inclusions):
        for level, material in enumerate(laws):
            for site in range(recipe.pokes_each):
                shared = site < recipe.protocol.shared_sites
                key = (shape, 0, site) if shared else (shape, 1 + level, site)
                seed = seed_of(recipe.seed, key)
                number = site if shared else site - recipe.protocol.shared_sites
                over = recipe.protocol.is_over_inclusion(number)
                scene = draw_scene(recipe, shape, inclusion, material, seed, over=over)
                check_drawn(recipe, shape, len(pokes), scene)
                pokes.append(
                    PlannedPoke(
                        index=len(pokes),
                        shape=shape,
                        level=level,
                        geometry=shape * len(laws) + level,
                        site=site,
                        shared=shared,
                        seed=seed,
                        scene=scene,
                    )
                )
    solved = one_solve(pokes)
    identity = {
        "format": FORMAT,
        "model": model,
        "recipe": recipe.identity(),
        "materials": {
            name: {**_stated(material), "stiffness": card.stiffness, **_taken(card)}
            for name, material, card in zip(recipe.levels, laws, cards, strict=True)
        },
        "versions": versions(),
        # labels depend on the element type, the mesh and the contact
        "element": ELEMENT,
        "mesh_layout": LAYOUT,
        "contact": CONTACT,
        # absent if each poke has its own solve, so that such stores stay as they were
        **({"one_solve": True} if any(poke.derived for poke in solved) else {}),
        **_added_code(laws, inclusions),
    }
    return Plan(
        recipe=recipe,
        model=model,
        cards=cards,
        materials=laws,
        inclusions=inclusions,
        pokes=solved,
        identity=json.loads(json.dumps(identity)),  # as it will be read back: lists for tuples
    )


def _with_levels(recipe: Recipe, folder: Path | None, levels: Sequence[str] | None) -> Recipe:
    """The recipe at the requested levels, or at all of the folder's cards if it has none of the recipe's."""
    if levels is not None:
        return recipe.with_levels(levels)
    if folder is None or any(card_path(name, folder).is_file() for name in recipe.levels):
        return recipe
    own = card_names(folder)
    if not own:
        return recipe
    log.info(
        "%s has no card of the recipe's material levels (%s): its own cards are the levels: %s.",
        folder,
        ", ".join(recipe.levels),
        ", ".join(own),
    )
    return recipe.with_levels(own)


def _card(name: str, folder: Path | None) -> Card:
    if folder is not None and not card_path(name, folder).is_file() and (own := card_names(folder)):
        raise InputError(
            f"{card_path(name, folder)}: no material card for material level {name}; the folder has "
            f"{', '.join(own)}: give --levels {','.join(own)} to take these"
        )
    return load_card(name, folder)


def _materials(cards: Sequence[Card], model: str, folder: Path | None) -> tuple[Material, ...]:
    """Materials of the cards with their effects, all in one law."""
    found: dict[str, Material] = {}
    for card in cards:
        try:
            found[card.material] = material_of(card, model)
        except InputError as error:
            raise InputError(f"{card_path(card.material, folder)}: {error}") from None
    return tuple(in_one_law(found).values())


def _check_clock(recipe: Recipe, cards: Sequence[Card], folder: Path | None) -> None:
    """Refuse viscous cards if the recipe has no course: the forces would depend on an assumed speed."""
    viscous = next((card for card in cards if card.viscosity is not None), None)
    if viscous is not None and not recipe.protocol.course:
        raise InputError(
            f"recipe {recipe.name}: expected key protocol.course, the rod's speeds and holds, since"
            f" {card_path(viscous.material, folder)} has key viscosity"
        )


def _stated(material: Material) -> dict[str, Any]:
    """Material as plain values, parts as in a card; absent parts have no key."""
    law = {"law": material.law, "parameters": material.parameters, "density": material.density}
    return {**law, **part_entries(material)}


def _taken(card: Card) -> dict[str, Any]:
    """Effects of a card that the dataset applies, under the key "effects"; empty if there are none."""
    taken = [e.model_dump(mode="json") for e in card.effects if not e.left_out(card.material)]
    return {"effects": taken} if taken else {}


def _added_code(materials: Sequence[Material], inclusions: Sequence[Inclusion]) -> dict[str, Any]:
    """sha256 of the code of laws, material parts and inclusion shapes from outside tisim: "extensions".

    Empty if there are none: versions then identify the code.
    """
    found = {f"law {m.law}": law for m in materials if (law := added(m.law)) is not None}
    kinds = {
        **{f"inclusion {body.kind}": type(body) for body in inclusions},
        **{f"part {part.name}": type(part) for m in materials for part in parts.of(m).values()},
    }
    code = {
        **{name: digest_of_code(*vars(law).values()) for name, law in found.items()},
        **{name: digest_of_code(kind) for name, kind in kinds.items() if not is_own(kind)},
    }
    return {"extensions": dict(sorted(code.items()))} if code else {}


def versions() -> dict[str, str]:
    """Versions of the packages on which the numbers depend."""
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
    """Short list of the keys in which two identities differ; "model" alone if that does."""
    keys = differences(old, new)
    if "model" in keys:
        return "model"
    order = ("recipe", "materials", "versions", "format")
    keys.sort(key=lambda key: order.index(key.split(".")[0]) if key.split(".")[0] in order else len(order))
    return ", ".join(keys[:3]) + (f" and {len(keys) - 3} more" if len(keys) > 3 else "")
