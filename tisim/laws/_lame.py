"""Laws with the Lame parameters mu and lam [Pa]; small strain: G = mu, K = lam + 2 mu/3."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

from tisim.laws._law import Law, Moduli, Parameters, scalar


def law_of_lame(
    *,
    name: str,
    title: str,
    theta: Literal["log", "linear", "trace"],
    energy: Any,
    kappa: Callable[[Parameters], float],
) -> Law:
    """A law of the family "invariant" with parameters mu and lam, whose energy reads mu."""
    return Law(
        name=name,
        title=title,
        parameters={"mu": ("Pa", "scalar"), "lam": ("Pa", "scalar")},
        family="invariant",
        theta=theta,
        energy=energy,
        pack=lambda p: (scalar(p, "mu"),),
        kappa=kappa,
        moduli=lambda p: Moduli(
            shear_modulus=scalar(p, "mu"), bulk_modulus=scalar(p, "lam") + 2.0 * scalar(p, "mu") / 3.0
        ),
        from_moduli=lambda shear, bulk: {"mu": shear, "lam": bulk - 2.0 * shear / 3.0},
    )
