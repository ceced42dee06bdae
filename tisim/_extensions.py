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
from pathlib import Path

VARIABLE = "TISIM_EXTENSIONS"


def load() -> None:
    """Import the extensions; ImportError, in one sentence, if one cannot be imported."""
    for entry in os.environ.get(VARIABLE, "").split(os.pathsep):
        if not entry:
            continue
        try:
            if entry.endswith(".py"):
                _load_file(Path(entry))
            else:
                importlib.import_module(entry)
        except Exception as error:
            raise ImportError(f"{VARIABLE}: {entry}: {type(error).__name__}: {error}") from error


def _load_file(path: Path) -> None:
    name = path.stem
    if name in sys.modules:
        return
    if not path.is_file():
        raise FileNotFoundError("expected a Python file that exists")
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
