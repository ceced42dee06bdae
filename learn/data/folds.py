"""The parts of a dataset: training, validation (chooses the epoch) and test."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from learn.data.store import Store, rigid_masks
from learn.errors import InputError

SplitBy = Literal["shape", "site"]
FOLDS = 5
PAPER_SHAPES = 11


@dataclass(frozen=True, eq=False)
class Split:
    """Frames of each part (rows of the store, in its order); groups: names of the shapes or sites in each."""

    train: NDArray[np.int64]
    validation: NDArray[np.int64]
    test: NDArray[np.int64]
    groups: dict[str, list[str]]


def split_pokes(
    store: Store,
    *,
    fold: int = 0,
    by: SplitBy = "shape",
    train_softness: list[str] | None = None,
    train_depth: float | None = None,
    seed: int = 0,
) -> Split:
    """Split a store into parts in the ratio 7 : 2 : 2 of its groups, rotated by the fold (0 to 4).

    With `by` "shape" the groups are the inclusion shapes: no tested shape was trained on. Up to 11 of them,
    the number of the paper (arXiv 2509.10125), are taken in the store's order, as there; more, which a recipe
    has drawn kind by kind, are dealt in turn, so that each part has shapes of every kind. With "site" they
    are sites (in random order), for stores of few shapes; pokes of one site at several softness levels stay
    together, since their displacements are similar. Training and validation parts are restricted to
    `train_softness` and to depths up to `train_depth` [m]; the test part is not. Of pokes that share one
    solve, scaled by the modulus (`Store.copies`), training and validation parts contain one, the test part
    all. Frames in which the retracting rod does not press are in no part: there is no force to predict.
    InputError if a part would be empty.
    """
    if not 0 <= fold < FOLDS:
        raise InputError(f"fold {fold}: expected 0 to {FOLDS - 1}")
    group, names = _groups(store, by, seed)
    count = len(names)
    held = max(1, round(count * 2 / 11))
    if count < 2 * held + 1:
        hint = "; split by site instead" if by == "shape" else ""
        raise InputError(
            f"{store.location}: {count} {by}s cannot be split into training, validation and test{hint}"
        )
    order = np.roll(_in_turn(count) if by == "shape" else np.arange(count), -fold * held)
    parts = {"train": order[2 * held :], "validation": order[held : 2 * held], "test": order[:held]}
    seen = _seen(store, train_softness, train_depth)
    of_frame = np.where(store.presses, group[store.frame_poke], -1)
    seen &= _one_of_each(store, seen)[store.frame_poke]
    rows = {}
    for part, members in parts.items():
        keep = np.isin(of_frame, members) & (seen if part != "test" else True)
        rows[part] = np.flatnonzero(keep)
        if not len(rows[part]):
            raise InputError(f"{store.location}: the {part} part of fold {fold} is empty")
    return Split(
        train=rows["train"],
        validation=rows["validation"],
        test=rows["test"],
        groups={part: [names[i] for i in sorted(members)] for part, members in parts.items()},
    )


def _one_of_each(store: Store, seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """True for the first poke (p,) of each solve that has frames in `seen`, or all if none are copies."""
    if not store.copies.any():
        return np.ones(store.pokes, dtype=bool)
    pokes = np.unique(store.frame_poke[seen])
    _, first = np.unique(store.solved_as[pokes], return_index=True)
    kept = np.zeros(store.pokes, dtype=bool)
    kept[pokes[first]] = True
    return kept


def frames_once(store: Store) -> NDArray[np.int64]:
    """All frames in which the indenter presses, (f,); of pokes that share one solve, those of one."""
    once = _one_of_each(store, store.presses)
    return np.flatnonzero(store.presses & once[store.frame_poke])


def _in_turn(count: int) -> NDArray[np.int64]:
    """Order of the shapes in which each of the parts in turn has every fifth; their own if they are few."""
    shapes = np.arange(count)
    return shapes if count <= PAPER_SHAPES else np.argsort(shapes % FOLDS, kind="stable")


class SplitRecipe(Protocol):
    """The keys of a training recipe that a split depends on."""

    @property
    def split(self) -> SplitBy: ...

    @property
    def fold(self) -> int: ...

    @property
    def train_softness(self) -> list[str] | None: ...

    @property
    def train_depth_mm(self) -> float | None: ...


def split_of(store: Store, recipe: SplitRecipe) -> Split:
    """Split a store by the keys of a recipe."""
    depth = recipe.train_depth_mm * 1e-3 if recipe.train_depth_mm else None
    return split_pokes(
        store, fold=recipe.fold, by=recipe.split, train_softness=recipe.train_softness, train_depth=depth
    )


def contact_points(store: Store, pokes: NDArray[np.int64]) -> NDArray[np.str_]:
    """A key of the shape, first contact and direction of each poke, the same in any dataset; shape (k,).

    Datasets of one recipe under several laws have the same contact points.
    """
    place = np.column_stack([store.path_start, store.direction])[pokes]
    texts = (
        f"{store.shapes[store.shape[poke]]} {' '.join(f'{v + 0.0:.9f}' for v in row)}"
        for poke, row in zip(pokes, place, strict=True)
    )
    return np.array([hashlib.sha256(t.encode()).hexdigest()[:20] for t in texts], dtype="U20")


def interiors(store: Store, pokes: NDArray[np.int64]) -> NDArray[np.str_]:
    """A key of the block and the inclusion of each poke, the same in any dataset; shape (k,).

    The names of shapes are no such key: recipes that draw shapes give different ones the same names.
    """
    masks, mask = rigid_masks(store.profile)
    inside = [np.packbits(m).tobytes() for m in masks]
    keys = []
    for geometry in range(len(store.profile)):
        sides = store.setups[int(store.setup_index[geometry])].block_size
        text = " ".join(f"{side:.6f}" for side in sides).encode()
        keys.append(hashlib.sha256(text + inside[int(mask[geometry])]).hexdigest()[:20])
    return np.array(keys, dtype="U20")[store.geometry[pokes]]


class SplitRun(Protocol):
    """A run with the recipe and the groups of its split."""

    @property
    def recipe(self) -> SplitRecipe: ...

    @property
    def uuid(self) -> str: ...

    @property
    def groups(self) -> dict[str, list[str]]: ...

    @property
    def seen(self) -> frozenset[str]: ...

    @property
    def folder(self) -> object: ...


def split_of_run(store: Store, run: SplitRun) -> Split:
    """Split a store as for a run; what was adapted to all of it (`learn.adaptation`) has no test part.

    InputError if the run was trained on it with other parts: when it was a part of what it is now, or by an
    earlier rule. Shapes that the run has seen would count as unseen.
    """
    if store.uuid == run.uuid and not run.groups["test"]:
        none = np.zeros(0, dtype=np.int64)
        return Split(train=frames_once(store), validation=none, test=none, groups=run.groups)
    split = split_of(store, run.recipe)
    if store.uuid == run.uuid and (split.groups != run.groups or _overlaps(store, split, run)):
        raise InputError(
            f"{run.folder}: was trained on other {run.recipe.split}s of {store.location} than its recipe now"
            " takes (the store was not complete, or the rule has changed): train it again"
        )
    return split


def _overlaps(store: Store, split: Split, run: SplitRun) -> bool:
    """True if a poke of the test part is at a contact point that the run has seen."""
    test = np.unique(store.frame_poke[split.test])
    return bool(np.isin(contact_points(store, test), list(run.seen)).any())


def _groups(store: Store, by: SplitBy, seed: int) -> tuple[NDArray[np.int64], list[str]]:
    """The group of each poke, -1 if it has no frames, and the groups' names."""
    used = store.done & (store.frame_count > 0)
    group = np.full(store.pokes, -1, dtype=np.int64)
    if by == "shape":
        shapes, group[used] = np.unique(store.shape[used], return_inverse=True)
        return group, [store.shapes[i] for i in shapes]
    keys = np.column_stack([store.shape, store.path_start, store.direction])[used]
    sites, place = np.unique(keys, axis=0, return_inverse=True)
    group[used] = np.random.default_rng(seed).permutation(len(sites))[place.reshape(-1)]
    return group, [f"site {i}" for i in range(len(sites))]


def _seen(store: Store, softness: list[str] | None, depth: float | None) -> NDArray[np.bool_]:
    seen = np.ones(store.frames, dtype=bool)
    if softness is not None:
        unknown = [name for name in softness if name not in store.softness_names]
        if unknown:
            known = ", ".join(store.softness_names)
            raise InputError(f"{store.location}: no softness {unknown[0]} there (it has {known})")
        wanted = np.array([name in softness for name in store.softness_names])
        seen &= wanted[store.softness[store.frame_poke]]
    if depth is not None:
        seen &= store.depth <= depth
    return seen
