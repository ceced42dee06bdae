"""Deferred import of Taichi, and the isochoric invariant and 10-vector used by laws.

A law's module uses the `ti` of this module (`from tisim.laws import ti`) with string annotations
(`from __future__ import annotations`), so that Taichi is imported only when the law is first evaluated. A
function decorated by Taichi's own `ti.func` is accepted as well.
"""

# mypy: disable-error-code="no-untyped-def"
# (Taichi compiles the functions of invariants)

from __future__ import annotations

import functools
import inspect
import linecache
from collections.abc import Callable
from typing import Any


class TaichiFunction:
    """A function for use in kernels, compiled by Taichi when a kernel first calls it.

    Its source is pickled with it, so that a law written in a notebook works in other processes.
    """

    _is_taichi_function = True  # Taichi's compiler requires this of a function that a kernel calls
    _is_real_function = False

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self._function = function
        self._compiled: Any = None

    @property
    def compiled(self) -> Any:
        """The function decorated by Taichi."""
        if self._compiled is None:
            from tisim.kernels._taichi import ti as taichi

            names = self._function.__globals__
            annotations = {
                name: eval(hint, names) if isinstance(hint, str) else hint  # Taichi needs objects
                for name, hint in self._function.__annotations__.items()
            }
            self._function.__annotations__ = annotations
            self._compiled = taichi.func(self._function)
        return self._compiled

    @property
    def func(self) -> Any:
        return self.compiled.func

    def __call__(self, *arguments: Any) -> Any:
        return self.compiled(*arguments)

    def __getstate__(self) -> dict[str, Any]:
        file = inspect.getsourcefile(self._function) or self._function.__code__.co_filename
        return {"function": self._function, "lines": linecache.getlines(file)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        file = state["function"].__code__.co_filename
        if not linecache.getlines(file):
            linecache.cache[file] = (sum(map(len, state["lines"])), None, state["lines"], file)
        self.__init__(state["function"])  # type: ignore[misc]


class _Taichi:
    """The module `taichi`, imported when one of its names other than `func` is first used."""

    func = staticmethod(TaichiFunction)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):  # looked up by pickle, doctest and inspect
            raise AttributeError(name)
        from tisim.kernels._taichi import ti as taichi

        return getattr(taichi, name)

    def __reduce__(self) -> str:
        return "ti"


ti: Any = _Taichi()


def lazy(energy: Any) -> TaichiFunction:
    """The function as a `TaichiFunction`; it may be plain, or decorated here or by Taichi."""
    if isinstance(energy, TaichiFunction):
        return energy
    if getattr(energy, "_is_taichi_function", False):
        energy = energy.func.func
    return TaichiFunction(energy)


@ti.func
def first_isochoric(I1, J):
    """I1bar = J^(-2/3) I1, and its derivative by I1."""
    a = ti.exp(-2.0 / 3.0 * ti.log(J))
    return a * I1, a


@ti.func
def by_invariants(w, d, dd, i1, a, J):
    """10-vector of w(I1bar) from w, its derivatives d and dd, I1bar = i1, and its derivative a by I1."""
    jac = -2.0 / 3.0 * i1 / J
    return ti.Vector(
        [
            w,
            d * a,
            0.0,
            d * jac,
            dd * a * a,
            0.0,
            dd * jac * jac + d * 10.0 / 9.0 * i1 / (J * J),
            0.0,
            dd * a * jac - d * 2.0 / 3.0 * a / J,
            0.0,
        ]
    )
