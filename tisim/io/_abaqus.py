"""Parser of Abaqus and CalculiX input files (.inp): nodes, elements and sets.

The keywords *NODE, *ELEMENT, *NSET and *ELSET (also GENERATE, and sets of sets), *SURFACE of element faces
and *INCLUDE are read, and data lines in another file (INPUT=). Keywords that move, copy or generate nodes are
refused; all others do not concern the mesh and are ignored. Names are case-insensitive and are converted to
lower case.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tisim.mesh import ElementKind, MeshError

SOLIDS: dict[str, ElementKind] = {"C3D4": "tet4", "C3D10": "tet10", "C3D8": "hex8", "C3D20": "hex20"}
_VARIANTS = ("", "H", "R", "RH", "I", "IH", "M", "MH", "T", "HS", "S", "MT", "MHT", "HT", "RT", "RHT")
# shells, membranes and rigid faces can define a part of the surface
_FACE_ELEMENTS = ("S3", "S4", "S6", "S8", "STRI", "R3D", "M3D", "SFM3D")
# corners of the faces S1 to S6, counted from 0; middle nodes follow from the corners
FACES = {
    "tet": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "hex": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
}
_REFUSED = {
    "NGEN": "nodes that are generated", "NFILL": "nodes that are generated", "NCOPY": "nodes that are copied",
    "NMAP": "nodes that are mapped", "ELGEN": "elements that are generated", "SYSTEM": "a coordinate system",
    "ELCOPY": "elements that are copied", "SUBMODEL": "a part of another model",
}  # fmt: skip
_WITH_INPUT = ("NODE", "ELEMENT", "NSET", "ELSET", "SURFACE")  # their data lines may be in a file
_DEEPEST = 10  # levels of included files
Names = dict[str, list["int | str"]]


@dataclass
class InputFile:
    """Mesh of an input file.

    Attributes
    ----------
    nodes : dict of int to list of float
        Coordinates by label, in the file's unit.
    elements : dict of int to (str, list of int)
        Element type and node labels by label.
    node_sets, element_sets : dict of str to list of int or str
        Labels of members and names of included sets, by name.
    surfaces : dict of str to list of (int or str, str)
        Pairs of an element or element set and a face ("S1"), by name.
    """

    nodes: dict[int, list[float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, list[int]]] = field(default_factory=dict)
    node_sets: Names = field(default_factory=dict)
    element_sets: Names = field(default_factory=dict)
    surfaces: dict[str, list[tuple[int | str, str]]] = field(default_factory=dict)

    def members(self, sets: Names, name: str, kind: str, seen: tuple[str, ...] = ()) -> list[int]:
        """Labels in a set and in sets that it includes; MeshError if one is missing or includes itself."""
        if name not in sets or name in seen:
            raise MeshError(f"{kind} {name!r} is named, and there is none")
        found: list[int] = []
        for entry in sets[name]:
            found += [entry] if isinstance(entry, int) else self.members(sets, entry, kind, (*seen, name))
        return found


def parse(path: Path) -> InputFile:
    """Read an input file and those that it includes; MeshError, in one sentence, if that fails."""
    found = InputFile()
    counts = {"PART": 0, "INSTANCE": 0}
    for where, keyword, options, rows in _blocks(path):
        try:
            _take(found, keyword, options, rows, counts)
        except (ValueError, IndexError) as error:
            text = str(error) if isinstance(error, MeshError) else f"*{keyword}: numbers are expected there"
            raise MeshError(f"{where}: {text}") from None
    return found


def kind_of(element: str) -> ElementKind | None:
    """Element type of tisim for one of Abaqus or CalculiX; None if there is none."""
    for stem in sorted(SOLIDS, key=len, reverse=True):
        if element.startswith(stem) and element.removeprefix(stem) in _VARIANTS:
            return SOLIDS[stem]
    return None


def _take(
    found: InputFile, keyword: str, options: dict[str, str], rows: list[list[str]], counts: dict[str, int]
) -> None:
    if keyword in _REFUSED or (keyword == "NODE" and options.get("SYSTEM", "R").upper() != "R"):
        raise MeshError(f"*{keyword}: {_REFUSED.get(keyword, 'a coordinate system')} cannot be read")
    if keyword in counts:
        counts[keyword] += 1
        if counts[keyword] > 1 or (keyword == "INSTANCE" and rows):
            raise MeshError(
                f"*{keyword}: expected one part, where it is, without a translation or a rotation"
            )
    elif keyword == "NODE":
        for row in rows:
            label, point = int(row[0]), [_real(x) for x in row[1:4]]
            point += [0.0] * (3 - len(point))
            if found.nodes.setdefault(label, point) != point:  # labels repeat in assemblies of parts
                raise MeshError(f"*NODE: node {label} is stated twice, in two places")
        _add(found.node_sets, options.get("NSET"), [int(row[0]) for row in rows])
    elif keyword == "ELEMENT":
        _elements(found, options, rows)
    elif keyword in ("NSET", "ELSET"):
        name = options.get(keyword)
        if name is None:
            raise MeshError(f"*{keyword}: the option {keyword}= is missing")
        sets = found.node_sets if keyword == "NSET" else found.element_sets
        if keyword == "NSET" and "ELSET" in options:
            raise MeshError("*NSET, ELSET=: nodes of an element set cannot be read; name the nodes")
        _add(sets, name, _labels(rows, "GENERATE" in options))
    elif keyword == "SURFACE" and options.get("TYPE", "ELEMENT").upper() == "ELEMENT":
        name = options.get("NAME")
        if name is None:
            raise MeshError("*SURFACE: the option NAME= is missing")
        pairs = [(_label(row[0]), row[1].upper() if len(row) > 1 else "") for row in rows]
        found.surfaces.setdefault(name.lower(), []).extend(pairs)


def _elements(found: InputFile, options: dict[str, str], rows: list[list[str]]) -> None:
    element = options.get("TYPE", "").upper()
    kind = kind_of(element)
    values = [int(x) for row in rows for x in row if x]
    if kind is None and not element.startswith(_FACE_ELEMENTS):
        raise MeshError(f"elements of type {element}: expected one of {', '.join(SOLIDS)}")
    if kind is None:  # one row per element
        entries = [[int(x) for x in row if x] for row in rows]
    else:
        width = 1 + int(SOLIDS[next(s for s in SOLIDS if SOLIDS[s] == kind)].strip("tehx"))
        if len(values) % width:
            raise MeshError(f"*ELEMENT, TYPE={element}: expected {width - 1} nodes an element")
        entries = [values[k : k + width] for k in range(0, len(values), width)]
    for label, *nodes in entries:
        if label in found.elements:
            raise MeshError(f"*ELEMENT: element {label} is stated twice")
        found.elements[label] = element, nodes
    _add(found.element_sets, options.get("ELSET"), [entry[0] for entry in entries])


def _add(sets: Names, name: str | None, labels: list[int] | list[int | str]) -> None:
    if name is not None:
        sets.setdefault(name.lower(), []).extend(labels)


def _labels(rows: list[list[str]], generate: bool) -> list[int | str]:
    if not generate:
        return [_label(x) for row in rows for x in row if x]
    found: list[int | str] = []
    for row in rows:
        first, last, step = int(row[0]), int(row[1]), int(row[2]) if len(row) > 2 and row[2] else 1
        if step < 1:
            raise MeshError(f"GENERATE: expected a step of 1 or more, got {step}")
        found += range(first, last + 1, step)
    return found


def _label(text: str) -> int | str:
    """A label or the name of a set, without the prefix of an instance; a name in quotes stays as it is."""
    if text.startswith('"'):
        return text.strip('"').lower()
    own = text.lower().rpartition(".")[2]
    return int(own) if own.isdigit() else own


def _real(text: str) -> float:
    """A number, also with a Fortran exponent (1.5D-3); 0 for an empty field."""
    return float(text.lower().replace("d", "e") or 0.0)


def _blocks(path: Path) -> Iterator[tuple[str, str, dict[str, str], list[list[str]]]]:
    """Location, keyword, options and data rows of each block of a file and of those that it includes."""
    block: tuple[str, str, dict[str, str], list[list[str]]] | None = None
    for where, text in _lines(path):
        if text.startswith("*"):
            if block is not None:
                yield block
            keyword, options = _keyword(text)
            block = where, keyword, options, []
        elif block is None:
            raise MeshError(f"{where}: expected a keyword, which begins with *, got {text[:40]!r}")
        else:
            block[3].append([x.strip() for x in text.removesuffix(",").split(",")])
    if block is not None:
        yield block


def _lines(path: Path, depth: int = 0) -> Iterator[tuple[str, str]]:
    """Location and text of each line but comments: continued keyword lines joined, other files' in place.

    A file is named by *INCLUDE, INPUT=, or by the option INPUT= of a keyword, of which it has data lines.
    """
    if depth > _DEEPEST:
        raise MeshError(f"{path}: expected at most {_DEEPEST} files that include one another")
    content = path.read_bytes()
    try:
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        if b"\0" in content:
            raise MeshError(f"{path}: expected a text file") from None
        lines = content.decode("latin-1").splitlines()
    unfinished = ""
    for number, line in enumerate(lines, start=1):
        where, text = f"{path}: line {number}", unfinished + line.strip()
        unfinished = ""
        if not text or text.startswith("**"):
            continue
        if text.startswith("*") and text.endswith(","):
            unfinished = text
            continue
        keyword, options = _keyword(text) if text.startswith("*") else ("", {})
        if keyword != "INCLUDE":
            yield where, text
        if keyword == "INCLUDE" or (keyword in _WITH_INPUT and "INPUT" in options):
            other = path.parent / options.get("INPUT", "")
            if not other.is_file():
                raise MeshError(f"{where}: *{keyword}: there is no file {other}")
            yield from _lines(other, depth + 1)


def _keyword(text: str) -> tuple[str, dict[str, str]]:
    """Keyword and options of a keyword line, in upper case but for the options' values."""
    keyword, *rest = [x.strip() for x in text[1:].split(",")]
    options = {k.strip().upper(): v.strip().strip('"') for k, _, v in (x.partition("=") for x in rest)}
    return " ".join(keyword.upper().split()), options


def as_arrays(found: InputFile) -> tuple[np.ndarray, dict[int, int]]:
    """Coordinates (n, 3) of the nodes, and the row of each label."""
    place = {label: k for k, label in enumerate(found.nodes)}
    return np.array(list(found.nodes.values()), dtype=float).reshape(-1, 3), place
