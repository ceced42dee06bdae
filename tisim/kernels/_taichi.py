"""The one place where Taichi is imported and started, so that a successor can replace it.

Kernels run serially on one core: a batch is spread over processes, one scene a core, which makes every
result independent of the number of workers, bit by bit.
"""

import contextlib
import inspect
import io
import os
import warnings
from typing import Any

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")

# Of each function that it decorates Taichi asks where the code around it stands. For a module that is being
# imported that is no file, and `inspect` looks for it in every module there is: a second among thousands. Its
# own table of files answers at once that no module is there.
_importing = os.path.normcase(os.path.abspath("<frozen importlib._bootstrap>"))  # noqa: PTH100 - no path
inspect.modulesbyfile[_importing] = ""

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # Taichi's own, of its Python AST use
    import taichi as ti
    from taichi.lang.ast import ast_transformer_utils


class _Unwrapped:
    """Stands in for the `TextWrapper` by which Taichi breaks a line of source for each node of a kernel's
    syntax tree, in case an error should have to show it: over half of the time that a kernel in its cache
    takes to load. Errors show the line as it is."""

    def __init__(self, **options: object) -> None: ...

    def wrap(self, text: str) -> list[str]:
        return [text] if text.strip() else []


ast_transformer_utils.TextWrapper = _Unwrapped
_position = ast_transformer_utils.ASTTransformerContext.get_pos_info


def _position_once(context: Any, node: Any) -> str:
    """Where a node of a kernel stands, for errors: Taichi writes it at each visit, and an unrolled loop
    visits its nodes again for each turn."""
    known: dict[Any, str] = context.__dict__.setdefault("_positions", {})
    if node not in known:
        known[node] = _position(context, node)
    return known[node]


ast_transformer_utils.ASTTransformerContext.get_pos_info = _position_once

f64 = ti.f64
i32 = ti.i32
_started = False


def ensure_runtime() -> None:
    """Start Taichi's CPU runtime once in this process."""
    global _started
    if _started:
        return
    with contextlib.redirect_stdout(io.StringIO()):  # it prints the backend's name
        _init()
    _started = True


def _init() -> None:
    ti.init(
        arch=ti.cpu,
        cpu_max_num_threads=1,
        default_fp=ti.f64,
        default_ip=ti.i32,
        fast_math=False,  # a reassociated sum would make results depend on the compiler's mood
        offline_cache=True,  # written when a process ends: others that run meanwhile compile for themselves
        # Half of the time of compiling, for kernels that LLVM makes as fast without it. Taichi's other passes
        # (advanced_optimization) are worth theirs: 20 % of the kernels' speed.
        cfg_optimization=False,
        log_level=ti.WARN,
        verbose=False,
    )


Kernel = Any
"""A compiled Taichi kernel or function (Taichi has no types for them)."""

__all__ = ["Kernel", "ensure_runtime", "f64", "i32", "ti"]
