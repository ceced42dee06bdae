"""The one place where Taichi is imported and started, so that a successor can replace it.

Kernels run serially on one core: a batch is spread over processes, one scene a core, which makes every
result independent of the number of workers, bit by bit.
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

# Of each function that it decorates Taichi asks where the code around it stands. For a module that is being
# imported that is no file, and `inspect` looks for it in every module there is: a second among thousands. Its
# own table of files answers at once that no module is there.
_importing = os.path.normcase(os.path.abspath("<frozen importlib._bootstrap>"))  # noqa: PTH100 - no path
inspect.modulesbyfile[_importing] = ""

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # Taichi's own, of its Python AST use
    import taichi as ti
    from taichi.lang import expr, impl, kernel_impl
    from taichi.lang.ast import ast_transformer_utils


# Most of the time that a kernel takes to load from Taichi's cache is Taichi's way through its syntax tree,
# whose result is the key to what lies there; and half of that way went into what only errors show, and into
# what is the same each time.
_visit = ast_transformer_utils.Builder.__call__
_position = ast_transformer_utils.ASTTransformerContext.get_pos_info


class _Failed:
    """Stands in for a visitor whose visit has failed, so that Taichi words the error as it does."""

    def __init__(self, error: Exception) -> None:
        self.error = error

    def __getattr__(self, name: str) -> Any:
        def again(*_: object) -> None:
            raise self.error

        return again


def _visit_unmarked(self: Any, context: Any, node: Any) -> Any:
    """Build a node without its source position, which Taichi formats for every node of a kernel in case of an
    error; here it is formatted once there is one."""
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
# a function's source is looked up, and each line of it laid out, at each call of it in a kernel
kernel_impl.getsourcelines = functools.cache(kernel_impl.getsourcelines)
kernel_impl.textwrap = SimpleNamespace(fill=functools.cache(textwrap.fill), dedent=textwrap.dedent)
# of each whole number NumPy is asked for the limits of its type
expr._check_in_range = functools.cache(expr._check_in_range)
expr._clamp_unsigned_to_range = functools.cache(expr._clamp_unsigned_to_range)

_call = kernel_impl.Kernel.__call__


def _call_known(self: Any, *given: Any) -> Any:
    """A kernel's later calls. Taichi works out each time what the arguments are, in 0.3 ms where the law at a
    hundred points takes a tenth of that; here they need only be what they were, and else Taichi has them."""
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
    """A compiled kernel and what its arguments are: dtype and number of axes, None of a number; empty where
    it has others than arrays of numbers, real numbers and whole ones, or gives something back."""
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
LONGEST_WRITE = 60.0  # of compiled kernels [s]


def ensure_runtime() -> None:
    """Start Taichi's CPU runtime once in this process."""
    global _started
    if _started:
        return
    with contextlib.redirect_stdout(io.StringIO()):  # it prints the backend's name
        _init()
    _remove_lock_of_the_dead()
    _started = True


def _remove_lock_of_the_dead() -> None:
    """The lock on compiled kernels of a process that was killed as it wrote them, in a second or less.

    As long as it lies there no process writes any, so that each compiles all its kernels.
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
        fast_math=False,  # a reassociated sum would make results depend on the compiler's mood
        offline_cache=True,  # written when a process ends: others that run meanwhile compile for themselves
        # Half of the time of compiling, for kernels that LLVM makes as fast without it. Taichi's other passes
        # (advanced_optimization) are worth theirs: 20 % of the kernels' speed.
        cfg_optimization=False,
        # Half of what is left of it: matrices are taken apart before Taichi's passes, not between them.
        force_scalarize_matrix=True,
        log_level=ti.WARN,
        verbose=False,
    )


Kernel = Any
"""A compiled Taichi kernel or function (Taichi has no types for them)."""

__all__ = ["Kernel", "ensure_runtime", "f64", "i32", "ti"]
