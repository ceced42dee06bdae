"""Import of files that add laws, inclusion shapes or kinds of scenes, named by an environment variable.

TISIM_EXTENSIONS contains paths of Python files or names of modules, with the separator of PATH. They are
imported at the end of `import tisim`, in every process, so that what they register is available to the
commands of factory, calibration and learn.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
import traceback
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

VARIABLE = "TISIM_EXTENSIONS"


class ExtensionError(ImportError):
    """An extension cannot be imported; the text is one sentence."""


def load() -> None:
    """Import the extensions; ExtensionError if one cannot be imported.

    A command then prints the sentence and ends with exit code 2. `import tisim` fails before any command of
    it can catch the error, so that the interpreter's hook for uncaught errors does this.
    """
    for entry in os.environ.get(VARIABLE, "").split(os.pathsep):
        if not entry:
            continue
        try:
            if entry.endswith(".py"):
                _load_file(Path(entry))
            else:
                importlib.import_module(entry)
        except Exception as error:
            sys.excepthook = partial(_shown, then=sys.excepthook)
            reason = f"{type(error).__name__}: {error}{_line_in(Path(entry), error)}"
            raise ExtensionError(f"{VARIABLE}: {entry}: {reason}") from error


def _shown(kind: type[BaseException], error: BaseException, trace: Any, *, then: Callable[..., Any]) -> None:
    if not isinstance(error, ExtensionError):
        then(kind, error, trace)
        return
    print(f"error: {error}", file=sys.stderr)
    raise SystemExit(2)


def _line_in(path: Path, error: Exception) -> str:
    """The last line of the file that the error passed through, in brackets; "" if it passed through none."""
    lines = [at.lineno for at in traceback.extract_tb(error.__traceback__) if at.filename == str(path)]
    return f" (line {lines[-1]})" if lines else ""


def _load_file(path: Path) -> None:
    name = path.stem
    if not path.is_file():
        raise FileNotFoundError("expected a Python file that exists")
    if name in sys.modules:
        there = getattr(sys.modules[name], "__file__", None)
        if there is None or not path.samefile(there):
            raise ImportError(f"another module is called {name}: expected another name of the file")
        return
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
