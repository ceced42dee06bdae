"""Content of a page, from a run and its dataset: a description, written as JSON, and arrays by name.

The description has the units of the page's controls, millimetres, degrees and kilopascals; displacements
and the interiors' codes have those of the graph (`learn.page.graph`).
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learn.data import Store, split_of_run
from learn.data._format import GRID, RIGID
from learn.errors import InputError
from learn.models import InvariantGnn, scene_on
from learn.page import controls, simulated
from learn.page.graph import INPUTS, Inputs, PagePart, interior_inputs
from learn.predictor import Predictor
from learn.quantities import shape_kind

NO_INCLUSION = "none"
_log = logging.getLogger(__name__)


@dataclass(eq=False, kw_only=True)
class Content:
    """A page's description (`about`), its arrays by name, the graph, and the graph's inputs by interior."""

    about: dict[str, Any]
    arrays: dict[str, NDArray[Any]]
    graph: PagePart
    inputs: list[Inputs] = field(default_factory=list)

    def packed(self) -> tuple[dict[str, Any], bytes]:
        """The description with type, shape and offset of each array, and all arrays concatenated."""
        places, parts, offset = {}, [], 0
        for name, array in self.arrays.items():
            places[name] = {"type": array.dtype.name, "shape": list(array.shape), "offset": offset}
            raw = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<")).tobytes()
            raw += b"\0" * (-len(raw) % 8)  # a typed array begins at a multiple of its items' size
            parts.append(raw)
            offset += len(raw)
        return {**self.about, "arrays": places}, b"".join(parts)


def content_of(predictor: Predictor, *, shapes: Sequence[str] | None = None, pokes: int = 4) -> Content:
    """Content of the page of a run.

    Parameters
    ----------
    predictor : predictor of one run of invariant-gnn or invariant-gnn-small, trained without time.
    shapes : inclusions of the dataset to offer, in one block; None: all, if their blocks are alike. A block
        without inclusion is always offered.
    pokes : largest number of simulated pokes of the test part; that it has fewer is logged as a warning.

    Raises
    ------
    InputError
        If the run has another model, the dataset lacks a shape, or the shapes stand in different blocks.
    """
    run, store, domain = predictor.run, predictor.store, predictor.domain
    model = run.model
    if not isinstance(model, InvariantGnn):
        what = "an ensemble" if run.members else f"a run of {run.recipe.model}"
        raise InputError(
            f"{run.folder}: expected one run of invariant-gnn or invariant-gnn-small, got {what}"
        )
    if model.takes_clock:
        raise InputError(f"{run.folder}: a model that was trained with time has no live page")
    simulated_shapes = [
        name for k, name in enumerate(store.shapes) if (store.done & (store.shape == k)).any()
    ]
    for name in shapes or ():
        if name not in simulated_shapes:
            raise InputError(f"--shape {name}: expected one of {', '.join(simulated_shapes)}")
    split = split_of_run(store, run)
    tested = np.unique(store.frame_poke[split.test])
    seen = {store.shapes[k] for k in store.shape[store.frame_poke[split.train]].tolist()}
    # shapes of the test part first: on them the surrogate is evaluated
    order = dict.fromkeys([*store.shape[tested].tolist(), *store.shape[store.done].tolist()])
    names = [store.shapes[k] for k in order if shapes is None or store.shapes[k] in shapes]
    setup = store.setups[store.setup_under(shapes)]
    scene = scene_on(setup, store.profile[:1])
    stencils = model.prepare(scene)
    graph = PagePart(model, scene, stencils, setup, domain, predictor.intervals)
    content = Content(about={"interiors": []}, arrays={}, graph=graph)
    for name in [*names, NO_INCLUSION]:
        profile, kind, label = _interior(store, name, name in seen)
        trained = domain is None or domain.kinds is None or kind is None or kind in domain.kinds
        inputs = interior_inputs(model, scene, stencils, profile, setup, trained_kind=trained)
        number = len(content.inputs)
        content.arrays |= {f"{key}-{number}": array for key, array in inputs.items()}
        content.arrays[f"spans-{number}"] = _spans(profile)
        content.inputs.append(inputs)
        content.about["interiors"].append({"name": name, "label": label, "kind": kind or "not known"})
    shown: list[dict[str, Any]] = []
    fewer = simulated.shortage(store, tested, names, pokes)
    if fewer is not None:
        _log.warning("%s", fewer)
    for poke in simulated.choose(store, tested, names, pokes):
        about, moved = simulated.described(store, poke, names.index(store.shapes[store.shape[poke]]))
        content.arrays[f"simulated-{len(shown)}"] = moved
        shown.append(about)
    content.about |= {
        "grid": GRID,
        "levels": len(setup.level_depth),
        "block": {
            "size": [1e3 * v for v in setup.block_size],
            "middle": (setup.middle * 1e3).tolist(),
            "top": setup.top * 1e3,
        },
        "rod": {"radius": setup.rod_radius * 1e3, "edge": setup.rod_edge * 1e3},
        "interior_inputs": INPUTS[1:],
        "sliders": controls.sliders(store, setup, domain),
        "checks": controls.checks(domain),
        "softness": controls.levels(store),
        "simulated": shown,
    }
    content.about["start"] = _start(store, content.about)
    return content


def _interior(store: Store, name: str, seen: bool) -> tuple[NDArray[np.uint8], str | None, str]:
    """Stored profile, kind of inclusion, and label in the page's menu."""
    if name == NO_INCLUSION:
        return np.zeros_like(store.profile[0]), NO_INCLUSION, "no inclusion"
    mine = (store.shape == store.shapes.index(name)) & store.done
    label = f"{name} ({'seen' if seen else 'not seen'} in training)"
    return store.profile[store.geometry[mine][0]], shape_kind(store, name), label


def _spans(profile: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """First rigid level under each point, and the level after the last, (n, 2); 0, 0 if there is none."""
    rigid = profile == RIGID
    first, last = rigid.argmax(axis=1), rigid.shape[1] - rigid[:, ::-1].argmax(axis=1)
    return np.where(rigid.any(axis=1)[:, None], np.stack([first, last], axis=1), 0).astype(np.uint8)


def _start(store: Store, about: dict[str, Any]) -> dict[str, Any]:
    """Initial poke of the page: the first simulated one at three quarters of its depth, or a central one."""
    if about["simulated"]:
        first = about["simulated"][0]
        return {**first["poke"], "depth": 0.75 * first["depths"][-1]}
    x, y = about["block"]["middle"]
    plain = {"interior": 0, "x": x, "y": y, "angle": 0.0, "heading": 0.0}
    return {**plain, "modulus": controls.middle_modulus(store), "depth": float(store.depth.max()) * 750}
