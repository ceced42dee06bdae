"""An answers file into its model, also one that lacks keys: what else it lacks is found in the same run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from calibration.errors import InputError
from calibration.experiment._yaml import problems_of, sentence, top_level
from calibration.new._answers import Answers
from calibration.new._asking import Nobody
from calibration.new._trial import NO_FILE
from tisim.io.bounded_yaml import as_tuples

# of keys that the schema asks for: what is expected, and what stands in until everything missing is named
_EXPECTED: dict[str, tuple[str, Any]] = {
    "name": ("name of the experiment", "s"),
    "id": ("name of the trial", None),  # which makes it different from others
    "file": ("the file with the machine's record", NO_FILE),
    "points": ("the file with the scan", NO_FILE),
    "captures": ("captures or markers", [{"outline": NO_FILE}]),
    "outline": ("an outline or a photo", NO_FILE),
    "markers": ("the file with the displacements of the markers", NO_FILE),
    "density_kg_m3": ("density of the material [kg/m3]", 1.0),
}
_LISTS = ("captures", "surfaces")  # of a trial, whose entries have keys of their own


def read_answers(path: Path, asker: Nobody) -> Answers:
    """An answers file; keys that it lacks go to `asker`, which names them with all others that are missing.

    Raises
    ------
    InputError
        It is missing or malformed: one sentence with the file, the key or line, and what was expected.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: expected a file with answers ({error.strerror})") from None
    data = top_level(content, path)
    names = _names(data.get("trials"))
    while True:
        given: Any = as_tuples(data)
        try:
            answers = Answers.model_validate(given)
            break
        except ValidationError as error:
            problems = problems_of(error)
            only = all(map(_is_missing, problems))  # an unknown key may be a missing one misspelt
            done = [only and _put_in(p, data, names, asker) for p in problems]
            if not all(done):
                asker.complete()  # else the error may be of what stands in
                raise InputError(f"{path}: {sentence(error, given)}") from None
    trials = [t.model_copy(update={"id": name}) for t, name in zip(answers.trials, names, strict=True)]
    return answers.model_copy(update={"trials": tuple(trials)})


def _names(trials: Any) -> list[str]:
    """The trials as messages have them: by id, or by number where they have none."""
    own = [t.get("id") if isinstance(t, dict) else None for t in trials] if isinstance(trials, list) else []
    return [name if isinstance(name, str) else f"trials[#{k}]" for k, name in enumerate(own, 1)]


def _is_missing(problem: Any) -> bool:
    if problem["type"] == "own_check":
        return str(problem["ctx"]["text"]).startswith("missing, ")
    # the place of a number that a list lacks ends with its index
    return problem["type"] == "union_tag_not_found" or (
        problem["type"] == "missing" and isinstance(problem["loc"][-1], str)
    )


def _put_in(problem: Any, data: dict[str, Any], names: list[str], asker: Nobody) -> bool:
    """Name a missing key and put in its place what lets the model be read; False where nothing can."""
    loc = list(problem["loc"])
    if problem["type"] == "own_check":
        loc += problem["ctx"]["key"].split(".")
    where, node, number = "", data, 0
    if loc[0] == "trials" and len(loc) > 1:
        number = loc[1]
        where, node = f"{names[number]}.", data["trials"][number]
        loc = loc[3:]  # behind the kind
        if not loc:
            asker.lack(f"{where}kind", "beam, poke or coupon", behind=names[number])
            data["trials"][number] = {"id": f"trial {number + 1}", "kind": "coupon", "file": NO_FILE}
            return True
        if loc[0] in _LISTS and len(loc) > 2:
            where, node, loc = f"{where}{loc[0]}[#{loc[1] + 1}].", node[loc[0]][loc[1]], loc[2:]
    elif loc[0] == "materials":
        where, node, loc = f"materials.{loc[1]}.", data["materials"][loc[1]], loc[2:]
    key = ".".join(map(str, loc))
    if len(loc) > 1:  # within a value that may be left out, and is then asked for as a whole or by its parts
        asker.lack(f"{where}{key}", "a value", behind=f"{where}{loc[0]}")
        node.pop(loc[0], None)
        return True
    text, value = _EXPECTED.get(key, ("it here", None))
    if problem["type"] == "own_check" and "beside" in problem["ctx"]["text"]:
        text += f", beside {problem['ctx']['text'].rpartition(' beside ')[2]}"  # which may be what is wrong
    asker.lack(f"{where}{key}", text, behind=f"{where}{key}")
    if key == "id":
        value = f"trial {number + 1}"
    elif key == "captures":
        asker.behind.add(f"{where}captures[#1]")
    if value is not None:
        node[key] = value
    return value is not None
