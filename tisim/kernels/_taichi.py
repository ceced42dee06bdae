"""Import and start of Taichi, in one module so that it can be replaced.

Kernels run serially on one core. A batch is distributed over processes, one scene per core, so that every
result is independent of the number of workers, bit by bit.
"""

import contextlib
import functools
import inspect
import io
import os
import textwrap
import time
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")

# For each function that it decorates, Taichi looks up the source file of the calling frame. During an import
# that is not a file, and `inspect` searches all modules for it, which takes a second among thousands. This
# entry of its table of files states at once that there is no module.
_importing = os.path.normcase(os.path.abspath("<frozen importlib._bootstrap>"))  # noqa: PTH100 - no path
inspect.modulesbyfile[_importing] = ""

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # Taichi's own, of its Python AST use
    import taichi as ti
    from taichi.lang import expr, impl, kernel_impl
    from taichi.lang.ast import ast_transformer_utils


# Most of the time of loading a kernel from Taichi's cache is Taichi's traversal of the syntax tree, which
# yields the cache key. Half of that was spent on text that only error messages show, and on repeated work.
_visit = ast_transformer_utils.Builder.__call__
_position = ast_transformer_utils.ASTTransformerContext.get_pos_info


class _Failed:
    """Replaces a visitor whose visit failed and raises its error again, for Taichi to format the message."""

    def __init__(self, error: Exception) -> None:
        self.error = error

    def __getattr__(self, name: str) -> Any:
        def again(*_: object) -> None:
            raise self.error

        return again


def _visit_unmarked(self: Any, context: Any, node: Any) -> Any:
    """Build a node without its source position, which is formatted only after an error.

    Taichi formats it for every node of a kernel.
    """
    visit = getattr(self, f"build_{type(node).__name__}", None)
    if visit is None:
        return _visit(self, context, node)
    try:
        return visit(context, node)
    except Exception as error:
        context.failed = True
        return _visit(_Failed(error), context, node)


def _position_of_errors(context: Any, node: Any) -> str:
    return _position(context, node) if hasattr(context, "failed") else ""


ast_transformer_utils.Builder.__call__ = _visit_unmarked
ast_transformer_utils.ASTTransformerContext.get_pos_info = _position_of_errors
impl.PyTaichi.get_current_src_info = lambda _: ""
# Taichi reads and wraps the source of a function at each of its calls in a kernel
kernel_impl.getsourcelines = functools.cache(kernel_impl.getsourcelines)
kernel_impl.textwrap = SimpleNamespace(fill=functools.cache(textwrap.fill), dedent=textwrap.dedent)
# Taichi asks NumPy for the limits of the type of each integer
expr._check_in_range = functools.cache(expr._check_in_range)
expr._clamp_unsigned_to_range = functools.cache(expr._clamp_unsigned_to_range)

_call = kernel_impl.Kernel.__call__


def _call_known(self: Any, *given: Any) -> Any:
    """Call a kernel; later calls with arguments of the same types skip Taichi's analysis of the arguments.

    That analysis takes 0.3 ms, ten times as long as a law at a hundred points. Calls with other types go to
    Taichi.
    """
    known = self.__dict__.get("known")
    if known is None:
        result = _call(self, *given)
        self.known = _known(self)
        return result
    if not known:
        return _call(self, *given)
    kernel, compiled, kinds = known
    context = kernel.make_launch_context()
    for slot, (value, (dtype, ndim)) in enumerate(zip(given, kinds, strict=True)):
        if ndim is None:
            if not isinstance(value, float if dtype is float else int):
                return _call(self, *given)
            (context.set_arg_float if dtype is float else context.set_arg_int)((slot,), value)
        else:
            if (
                type(value) is not np.ndarray
                or value.dtype != dtype
                or value.ndim != ndim
                or not value.flags.c_contiguous
            ):
                return _call(self, *given)
            start = value.__array_interface__["data"][0]
            context.set_arg_external_array_with_shape((slot,), start, value.nbytes, value.shape, 0)
    self.runtime.prog.launch_kernel(compiled, context)
    return None


def _known(kernel: Any) -> tuple[Any, Any, list[tuple[Any, int | None]]] | tuple[()]:
    """Compiled kernel and, for each argument, its dtype and number of axes (None for a scalar).

    Empty if the kernel returns a value, or an argument is neither an array of known type nor a float or int.
    """
    kinds: list[tuple[Any, int | None]] = []
    for argument in kernel.arguments:
        kind = argument.annotation
        if (
            isinstance(kind, kernel_impl.ndarray_type.NdarrayType)
            and kind.dtype in _ARRAYS
            and kind.ndim is not None
        ):
            kinds.append((_ARRAYS[kind.dtype], kind.ndim))
        elif kind in _NUMBERS:
            kinds.append((_NUMBERS[kind], None))
        else:
            return ()
    if kernel.return_type is not None or len(kernel.compiled_kernels) != 1:
        return ()
    (made,) = kernel.compiled_kernels.values()
    prog = kernel.runtime.prog
    return made, prog.compile_kernel(prog.config(), prog.get_device_caps(), made), kinds


kernel_impl.Kernel.__call__ = _call_known
_ARRAYS = {ti.f64: np.dtype(np.float64), ti.i32: np.dtype(np.int32)}
_NUMBERS = {ti.f64: float, ti.i32: int}

f64 = ti.f64
i32 = ti.i32
_started = False
LONGEST_WRITE = 60.0  # longest time to write compiled kernels [s]


def ensure_runtime() -> None:
    """Start Taichi's CPU runtime once in this process."""
    global _started
    if _started:
        return
    with contextlib.redirect_stdout(io.StringIO()):  # Taichi prints the backend's name
        _init()
    _remove_lock_of_the_dead()
    _started = True


def _remove_lock_of_the_dead() -> None:
    """Remove an old lock on the cache of kernels, left by a process that was killed while it wrote to it.

    Writing takes a second or less. While the lock exists no process writes, and each compiles all kernels.
    """
    lock = Path(impl.current_cfg().offline_cache_file_path) / "ticache.lock"
    with contextlib.suppress(OSError):
        if time.time() - lock.stat().st_mtime > LONGEST_WRITE:
            lock.unlink()


def _init() -> None:
    ti.init(
        arch=ti.cpu,
        cpu_max_num_threads=1,
        default_fp=ti.f64,
        default_ip=ti.i32,
        fast_math=False,  # reassociated sums would make results depend on the compiler
        offline_cache=True,  # written at the end of a process: concurrent processes compile their own kernels
        # This pass takes half of the compile time, and LLVM's kernels are as fast without it. Taichi's other
        # passes (advanced_optimization) are worth their time: 20 % of the kernels' speed.
        cfg_optimization=False,
        # Halves the remaining time: matrices are split into scalars before Taichi's passes, not between them.
        force_scalarize_matrix=True,
        log_level=ti.WARN,
        verbose=False,
    )


Kernel = Any
"""A compiled Taichi kernel or function (Taichi has no types for them)."""

__all__ = ["Kernel", "ensure_runtime", "f64", "i32", "ti"]
