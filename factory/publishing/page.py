"""The page of a dataset's card: Markdown with the front matter that Hugging Face reads."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import yaml

from factory.cli import counted, duration, sides_text, size_text
from factory.inspection import paper_table
from factory.inspection.features import Features, measures
from factory.publishing.facts import Facts, beside_the_paper, size_category, solves

_SNIPPET = """```python
import zarr

store = zarr.open_group("{name}", mode="r")
poke = {poke}
first, count = int(store["frame_start"][poke]), int(store["frame_count"][poke])
frames = slice(first, first + count)
depth = store["depth"][frames]  # m
force = store["rod_force"][frames]  # N
surface = {rest} + store["grid_displacement"][frames]  # m, frames x 32 x 32 x 3
print(f"poke {{poke}}: {{1e3 * depth.max():.2f}} mm, {{(force**2).sum(axis=1).max() ** 0.5:.3f}} N")
```"""


def page(facts: Facts) -> str:
    """Markdown text of the whole page."""
    sections = (
        _front(facts),
        _head(facts),
        _holds(facts),
        _simulated(facts),
        _reached(facts),
        _accuracy(facts),
        _cost(facts),
        _load(facts),
        _licence(facts),
    )
    return "\n\n".join(text for section in sections for text in section) + "\n"


def _front(facts: Facts) -> Iterator[str]:
    summary = facts.summary
    entries = {
        "license": facts.licence.lower(),
        "pretty_name": _title(facts),
        "size_categories": [size_category(_frames(facts))],
        "tags": [
            "soft tissue",
            "indentation",
            "hyperelasticity",
            "finite element method",
            "zarr",
            summary.model,
        ],
        "viewer": False,  # Hugging Face's viewer reads tables, not Zarr
    }
    yield "---\n" + yaml.safe_dump(entries, sort_keys=False, allow_unicode=True).rstrip() + "\n---"


def _head(facts: Facts) -> Iterator[str]:
    attributes = facts.data.attributes
    yield f"# {_title(facts)}"
    yield (
        'Indentations ("pokes") of blocks of soft tissue with a rigid inclusion: '
        f"{counted(len(facts.summary.done), 'simulated poke')} with {_frames(facts)} equilibrium states, "
        "each with depth, forces and the deformed surface. "
        "`python -m factory.card` of tisim made this page from the store."
    )
    date = facts.date.isoformat() if facts.date else "not recorded"
    yield _table(
        ("", ""),
        [
            (
                "store",
                f"`{facts.data.path.resolve().name}`, {size_text(facts.data.size_of())}, "
                f"{len(facts.sums)} files",
            ),
            ("uuid", f"`{attributes['uuid']}`"),
            ("fingerprint", f"`{attributes['fingerprint']}`"),
            ("completed", date),
        ],
    )


def _holds(facts: Facts) -> Iterator[str]:
    summary, recipe = facts.summary, facts.identity["recipe"]
    protocol = recipe["protocol"]
    each = protocol["shared_sites"] + protocol["own_sites"]
    yield "## Content"
    failed = f", of which {len(summary.failed)} failed" if summary.failed else ""
    failed += f", of which {summary.waiting} are not simulated yet" if summary.waiting else ""
    yield (
        f"Recipe `{recipe['name']}`: {recipe.get('description', '')}. {len(summary.shapes)} shapes x "
        f"{len(summary.levels)} material levels x {each} contact points = {summary.pokes} pokes{failed}. "
        f"Of the contact points of a shape, {protocol['shared_sites']} are common to all material levels, "
        f"and {protocol['own_sites']} are drawn for each level. The seed is {facts.data.attributes['seed']}."
    )
    head: tuple[str, ...] = ("rigid inclusion", "kind", "mm")
    shapes: list[tuple[str, ...]]
    shapes = [(f"`{shape['id']}`", shape.get("kind", ""), _lengths(shape)) for shape in recipe["shapes"]]
    if _own_blocks(facts):
        head = (*head, "block [mm]")
        shapes = [(*row, sides_text([block])) for row, block in zip(shapes, _blocks(facts), strict=True)]
    yield _table(head, shapes)
    rows = [
        (
            f"`{m.level}`",
            ", ".join(f"{key} = {_value(value)}" for key, value in m.parameters.items()),
            f"{m.shear / 1e3:.4g}",
            f"{m.bulk / 1e3:.4g}",
            f"{m.density:g}",
        )
        for m in facts.materials
    ]
    head = ("material level", f"parameters ({facts.data.attributes['model']}; moduli in Pa)")
    yield _table((*head, "shear modulus [kPa]", "bulk modulus [kPa]", "density [kg/m3]"), rows)
    parts = facts.data.attributes.get("parts")
    if parts:
        stated = [
            f"- `{level}`: " + "; ".join(f"{key} {_value(value)}" for key, value in part.items())
            for level, part in zip(summary.levels, parts, strict=True)
            if part
        ]
        yield "Parts beside the law:\n\n" + "\n".join(stated)


def _simulated(facts: Facts) -> Iterator[str]:
    recipe, table = facts.identity["recipe"], facts.data.table
    protocol, rod = recipe["protocol"], recipe["rod"]
    nodes, elements = (table[name][table["done"]] for name in ("mesh_nodes", "mesh_elements"))
    course = protocol.get("course")
    motion = "along a course over time (quasi-static)" if course else "in quasi-static steps, without time"
    versions = ", ".join(f"{name} {number}" for name, number in facts.identity["versions"].items())
    # of stores that were built before these were recorded nothing is known
    parts = [
        (name, facts.identity.get(key)) for name, key in (("mesh", "mesh_layout"), ("contact", "contact"))
    ]
    versions += "".join(f", {name} {number}" for name, number in parts if number is not None)
    block = f"Block: {sides_text(_blocks(facts))} mm"
    if _own_blocks(facts):
        block += ", one for each shape"
    tolerance = facts.data.attributes["solver_tolerance"]
    yield "## Simulation"
    lines = [
        f"Law: `{facts.data.attributes['model']}`; finite elements in large deformation, static equilibrium.",
        f"{block}, its base and the inclusion fixed.",
        f"Indenter: {rod['tip']}, radius {rod['radius_mm']:g} mm, edge radius {rod['edge_radius_mm']:g} mm; "
        f"contact with a Coulomb friction coefficient of {recipe['friction']:g}.",
        f"Motion: up to {protocol['depth_mm']:g} mm from first contact, up to "
        f"{protocol['max_angle_deg']:g} degrees from the normal, {motion}; a frame every "
        f"{protocol['frame_spacing_mm']:g} mm.",
        f"Mesh: {nodes.min()} to {nodes.max()} nodes (mean {nodes.mean():.0f}), {elements.min()} to "
        f"{elements.max()} elements, refinement {recipe['refinement']:g}.",
        f"Solver: residual force below {tolerance:g} of the load in every frame.",
        f"Versions: {versions}.",
    ]
    if course:
        pieces = (_value({key: v for key, v in piece.items() if v is not None}) for piece in course)
        lines.append(f"Course: {'; '.join(pieces)}.")
    derived = len(facts.summary.done) - solves(facts)
    if derived:
        lines.append(
            f"Shared solves: {derived} of the {len(facts.summary.done)} pokes differ from another only by a "
            "factor of the moduli. They have its displacements, and its forces times `force_factor`; "
            "`solved_as` names it."
        )
    else:
        lines.append("Every poke was solved itself.")
    yield "\n".join(f"- {line}" for line in lines)


def _reached(facts: Facts) -> Iterator[str]:
    summary = facts.summary
    yield "## Depths and forces"
    yield "![Deepest frame and largest force by shape and softness](features.png)"
    yield (
        "Mean ± standard deviation over pokes (deepest frame, largest force) and over frames; "
        "`softness.csv` has the same values, `features.csv` those of each shape and softness."
    )
    rows = []
    for level in summary.levels:
        pokes = [poke for poke in summary.done if poke.level == level]
        found = measures(pokes)
        cells = _pairs(found) if found else ["-"] * 4
        rows.append((f"`{level}`", str(len(pokes)), *cells))
        paper = paper_table.PAPER.get(summary.model, {}).get(level)
        if paper:
            rows.append((f"`{level}`, the paper's", str(paper_table.pokes_a_level()), *_pairs(paper)))
    measured = ("deepest [mm]", "largest force [N]", "depth per frame [mm]", "force per frame [N]")
    yield _table(("material level", "pokes", *measured), rows)
    if beside_the_paper(facts):
        snapshots = paper_table.SNAPSHOTS.get(summary.model)
        theirs = (
            f" It has {snapshots} snapshots of this law, from pokes with a requested depth of "
            f"{paper_table.DEPTH_MM:g} mm."
        )
        yield f"Rows of the paper: {paper_table.SOURCE}.{theirs if snapshots else ''}"
    yield (
        "By shape: means, in brackets the smallest of the deepest frames and the largest force; fraction of "
        "the requested depth that was reached; number of pokes that ended before it."
    )
    yield _table(
        ("shape", "softness", "pokes", "deepest [mm]", "force [N]", "reached", "ended early"),
        [_row(row) for row in facts.rows],
    )
    yield "Reasons why pokes ended: " + _ends(facts) + "."
    poke = facts.data.poke(facts.shown)
    yield f"![Poke {poke.index}: {poke.shape}, {poke.level}](poke.png)"
    yield f"*Poke {poke.index}, the deepest: {poke.shape} in {poke.level}, {1e3 * poke.depth.max():.2f} mm.*"


def _accuracy(facts: Facts) -> Iterator[str]:
    worst = facts.worst
    yield "## Accuracy"
    yield "`python -m factory.verify` checked every file and every frame, and found:"
    yield _table(("check", "faults"), [(name, str(len(found))) for name, found in facts.found.faults.items()])
    yield (
        f"Worst values of all frames: residual {worst.residual:.2g} of the load; difference of base reaction "
        f"and indenter force {worst.force_gap:.2g} of the force; smallest det F {worst.min_jacobian:.3g}; "
        f"overlap of tissue and indenter {1e3 * worst.penetration:.3g} mm."
    )
    yield (
        "These checks concern the equilibrium of the discrete model, not its discretisation error. "
        "`studies/depth` of tisim compares the force with independent solvers by depth, and "
        "`docs/explanation/simulation.md` states the accuracy of each kind of scene."
    )


def _cost(facts: Facts) -> Iterator[str]:
    yield "## Cost"
    cost = facts.cost
    if cost is None:
        yield "The ledger of the store has no times."
        return
    needed = solves(facts)
    if cost.solves != needed:
        yield (
            f"The ledger lists {cost.solves} solves, the store has {needed}; the times are those of the "
            "listed ones."
        )
    yield (
        f"{cost.solves} solves took {cost.core_seconds:.1f} core-seconds ({duration(cost.core_seconds)}), "
        f"{cost.core_seconds / cost.solves:.2f} per solve; "
        f"the longest {cost.longest:.1f} s of wall time (`provenance/ledger.jsonl` in the store)."
    )


def _load(facts: Facts) -> Iterator[str]:
    name = facts.data.path.resolve().name.removesuffix(".zip")
    yield "## Loading"
    rest = 'store["grid_rest"][int(store["poke_geometry"][poke])]'
    if not _own_blocks(facts):
        rest = 'store["grid_rest"][:]'
    yield _SNIPPET.format(name=name, poke=facts.shown, rest=rest)
    yield (
        "The zip is read without unpacking: "
        f'`zarr.open_group(zarr.storage.ZipStore("{name}.zip"), mode="r")`. '
        "Positions and forces are in m and N; `docs/reference/dataset-format.md` of tisim explains "
        "every array. "
        "`sha256sum -c SHA256SUMS` in the store's folder checks every file; "
        f"`python -m factory.verify {name}` checks the physics too."
    )


def _licence(facts: Facts) -> Iterator[str]:
    attributes = facts.data.attributes
    year = f"\n  year    = {{{facts.date.year}}}," if facts.date else ""
    authors = " and ".join(_tex(f"{{{name}}}" if name.startswith("The ") else name) for name in facts.authors)
    yield "## Licence and citation"
    yield f"{facts.licence}. To cite the dataset:"
    yield (
        f"```bibtex\n@misc{{tisim-pokes-{attributes['uuid'][:8]},\n"
        f"  title   = {{{_tex(_title(facts))}}},\n"
        f"  author  = {{{authors}}},{year}\n"
        f"  version = {{tisim {facts.identity['versions'].get('tisim', 'not recorded')}}},\n"
        f"  note    = {{Dataset, uuid {attributes['uuid']}, "
        f"fingerprint {attributes['fingerprint'][:16]}}}\n}}\n```"
    )
    yield "`CITATION.cff` of tisim states how to cite the programs."


def _title(facts: Facts) -> str:
    summary = facts.summary
    return f"Simulated pokes of soft tissue: {summary.recipe}, {summary.model}, {len(summary.done)} pokes"


def _frames(facts: Facts) -> int:
    return len(facts.data.table["frame_poke"])


def _ends(facts: Facts) -> str:
    ended: Counter[str] = Counter()
    for row in facts.rows:
        ended.update(row.ended)
    return ", ".join(f"{name} {count}" for name, count in ended.most_common())


def _row(row: Features) -> tuple[str, ...]:
    early = [f"{count} {name}" for name, count in row.ended.items() if name != "converged"]
    return (
        f"`{row.shape}`",
        f"`{row.level}`",
        str(row.pokes),
        "-" if row.deepest is None else f"{row.deepest.mean:.2f} ({row.deepest.low:.2f})",
        "-" if row.force is None else f"{row.force.mean:.2f} ({row.force.high:.2f})",
        "-" if row.reached is None else f"{row.reached:.2f}",
        ", ".join(early) or "-",
    )


def _pairs(pairs: Sequence[tuple[float, float]]) -> list[str]:
    return [f"{mean:.2f} ± {sd:.2f}" for mean, sd in pairs]


def _blocks(facts: Facts) -> list[list[float]]:
    """Sides of the block of each shape [mm]."""
    recipe = facts.identity["recipe"]
    return [shape.get("block_mm", recipe["block_mm"]) for shape in recipe["shapes"]]


def _own_blocks(facts: Facts) -> bool:
    """True if each shape has a block of its own."""
    return "block_mm" in facts.identity["recipe"]["shapes"][0]


def _lengths(shape: dict[str, Any]) -> str:
    lengths = {
        key[:-3]: value
        for key, value in shape.items()
        if key.endswith("_mm") and key != "block_mm" and value is not None
    }
    return ", ".join(f"{key} {_value(value)}" for key, value in lengths.items())


def _value(value: Any) -> str:
    if isinstance(value, list | tuple):
        return "(" + ", ".join(_value(v) for v in value) + ")"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_value(v)}" for key, v in value.items())
    if isinstance(value, float | np.floating) and math.isfinite(value):
        return f"{value:g}"
    return str(value)


def _tex(text: str) -> str:
    return re.sub(r"([&%$#_])", r"\\\1", text)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)
