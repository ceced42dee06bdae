"""Added laws and kinds of scenes, which are sent to other processes with the scenes that need them."""

from __future__ import annotations

import hashlib
import inspect
import io
import logging
import pickle
from collections import ChainMap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import CodeType
from typing import Any, ClassVar

from tisim import laws
from tisim.problems import _registry

_log = logging.getLogger(__name__)
_adopted: dict[str, str] = {}


@dataclass(frozen=True)
class Extension:
    """A pickled law or kind of scene, with a name and a digest that identify it."""

    name: str
    digest: str
    pickled: bytes

    @staticmethod
    def of(name: str, thing: Any) -> Extension:
        data = _pickled(thing)
        return Extension(name, hashlib.sha256(data).hexdigest(), data)


def _pickled(thing: Any) -> bytes:
    """Pickle by value, and code with its file name, from which Taichi compiles a function.

    cloudpickle omits the file name from version 3.1.3 on.
    """
    from cloudpickle import cloudpickle  # type: ignore[import-untyped]  # loky needs it as well

    by_type = cloudpickle.CloudPickler.dispatch_table
    reduce_code = by_type[CodeType]

    def with_file(code: CodeType) -> tuple[Any, ...]:
        make, arguments = reduce_code(code)
        return make, tuple(code.co_filename if a == "<dynamic-code>" else a for a in arguments)

    class Pickler(cloudpickle.CloudPickler):
        dispatch_table: ClassVar[Any] = ChainMap({CodeType: with_file}, by_type)

    buffer = io.BytesIO()
    Pickler(buffer).dump(thing)
    return buffer.getvalue()


def needed(scenes: Sequence[Any]) -> tuple[Extension, ...] | None:
    """Registered extensions that scenes use; None if they cannot be sent to another process."""
    found: dict[str, Any] = {}
    for scene in scenes:
        law, kind = laws.added(scene.material.law), _registry.added(scene)
        if law is not None:
            found[f"law {law.name}"] = law
        if kind is not None:
            found[f"kind {kind.name}"] = kind
    try:
        return tuple(Extension.of(name, thing) for name, thing in sorted(found.items()))
    except Exception as error:  # whatever a user's functions refer to
        _log.warning(
            "%s: cannot be sent to other processes (%s); solved in this one", ", ".join(found), error
        )
        return None


def is_own(thing: Any) -> bool:
    """True for a class or function that comes with tisim."""
    return str(thing.__module__).partition(".")[0] == "tisim"


def digest_of_code(*things: Any) -> str:
    """sha256 of the code of classes and functions (others are skipped), wherever their files stand.

    The whole source of each one's module counts, since it may call others there; of one without a source
    file, the pickled code.
    """
    sources = set()
    for thing in things:
        code = inspect.unwrap(thing) if callable(thing) else None
        if not (inspect.isclass(code) or inspect.isfunction(code)) or is_own(code):
            continue
        try:
            sources.add("".join(inspect.findsource(code)[0]).encode())
        except (OSError, TypeError):
            sources.add(_pickled(code))
    return hashlib.sha256(b"\0".join(sorted(sources))).hexdigest()


def adopt(extensions: Sequence[Extension]) -> None:
    """Register extensions that another process has sent, unless they are registered already."""
    for extension in extensions:
        if _adopted.get(extension.name) != extension.digest:
            thing = pickle.loads(extension.pickled)
            add: Callable[[Any], Any] = laws.register if isinstance(thing, laws.Law) else _registry.register
            add(thing)
            _adopted[extension.name] = extension.digest
