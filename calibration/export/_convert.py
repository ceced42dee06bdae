"""Form of a law for another program: the same if the program has it, else the nearest, with its error."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from calibration.errors import InputError
from calibration.export._forms import Form, exact, isochoric_twin
from calibration.export._response import (
    MODES,
    Difference,
    Stability,
    Stress,
    compare,
    nominal,
    percent,
    pressure_difference,
    stability,
    stress_of,
    stretches_of,
    worst,
)
from tisim import Material, laws

# Volume ratio at which two volumetric energies are compared.
SQUEEZED = 0.99


@dataclass(frozen=True, kw_only=True)
class Conversion:
    """A material's law as a program has it.

    Attributes
    ----------
    form : Form
        What the program is given.
    how : "same", "volume" or "fit"
        The law itself; the law but for its volumetric part; another law with the same moduli at rest.
    differences : tuple of Difference
        Of stress in homogeneous tests over the stretches that were asked for.
    pressure : float
        Relative difference of pressure where the volume is 1 % smaller.
    poisson : float or None
        Poisson's ratio of the card, where the form has a smaller one.
    unstable : tuple of Stability
        Tests in which a law that stands for another one is not stable, within or little beyond the stretches
        that were asked for.
    unstable_card : tuple of Stability
        The same of the card's own law, where another one stands for it.
    """

    form: Form
    how: str
    differences: tuple[Difference, ...]
    pressure: float
    poisson: float | None = None
    unstable: tuple[Stability, ...] = ()
    unstable_card: tuple[Stability, ...] = ()


def convert(
    material: Material,
    writes: Callable[[Form], Form | None],
    *,
    low: float,
    high: float,
    most_loss: float,
    program: str,
    most_poisson: float | None = None,
) -> Conversion:
    """The best form for a law that a program can write.

    Parameters
    ----------
    material : Material
        Without memory and fibres.
    writes : callable
        A form to that which the program makes of it (its own volumetric energy), None where it has none.
    low, high : float
        Principal stretches between which stresses are compared.
    most_loss : float
        Largest rms difference of stress, as a fraction.
    program : str
        For the sentence.
    most_poisson : float, optional
        A larger Poisson's ratio is lowered to this one, Young's modulus kept.

    Raises
    ------
    InputError
        Where the best form is further off than `most_loss`.
    """
    law = laws.get(material.law)
    card = stress_of(material)
    moduli = law.moduli(material.parameters)
    own = Form(kind="neo-hookean", bulk=moduli.bulk_modulus, mu=(moduli.shear_modulus,))
    capped = most_poisson is not None and own.poisson > most_poisson

    def fitting(form: Form) -> Form | None:
        found = writes(form)
        if found is not None and capped:
            assert most_poisson is not None
            found = with_poisson(found, most_poisson)
        return found

    best: Conversion | None = None
    for how, form in _candidates(material, card, low, high):
        made = fitting(form)
        if made is None:
            continue
        same = how == "same" and made == form
        found = Conversion(
            form=made,
            how="same" if same else ("volume" if how in ("same", "volume") else "fit"),
            differences=compare(card, made.stress, low, high),
            pressure=pressure_difference(card, made, SQUEEZED),
            poisson=own.poisson if capped else None,
        )
        if how in ("same", "volume"):
            best = found
            break
        if best is None or _size(found) < _size(best):
            best = found
    if best is None:
        raise InputError(f"--to {program}: has no law that could stand for {law.name}")
    if not _size(best) <= most_loss:
        off = worst(best.differences)
        raise InputError(
            f"--to {program}: {law.name} has no counterpart there: the nearest, {best.form.kind}, is"
            f" {percent(off.rms)} off in {off.mode} tests between stretches of {off.low:.3g} and"
            f" {off.high:.3g}, and at most {percent(most_loss)} is accepted (--most-loss)"
        )
    if best.how == "fit" and best.form.kind != "arruda-boyce":  # which is stable as far as its chains reach
        limits, own_limits = stability(best.form.stress, low, high), stability(card, low, high)
        return replace(best, unstable=limits, unstable_card=own_limits)
    return best


def _size(conversion: Conversion) -> float:
    size = worst(conversion.differences).rms
    return size if np.isfinite(size) else np.inf


def with_poisson(form: Form, poisson: float) -> Form:
    """The form with another Poisson's ratio and the same Young's modulus at small strain."""
    shear = form.young / (2.0 * (1.0 + poisson))
    bulk = form.young / (3.0 * (1.0 - 2.0 * poisson))
    factor = shear / form.shear_modulus
    return replace(
        form,
        bulk=bulk,
        mu=tuple(factor * m for m in form.mu),
        terms=tuple((ij, factor * c) for ij, c in form.terms),
    )


def _candidates(material: Material, card: Stress, low: float, high: float) -> Iterator[tuple[str, Form]]:
    parameters = material.parameters
    same = exact(material.law, parameters)
    if same is not None:
        yield "same", same
    twin = isochoric_twin(material.law, parameters)
    if twin is not None:
        yield "volume", twin
    moduli = laws.get(material.law).moduli(parameters)
    G, K = moduli.shear_modulus, moduli.bulk_modulus
    at = {mode: stretches_of(mode, low, high) for mode in MODES}
    wanted = {mode: nominal(card, mode, at[mode]) for mode in MODES}

    def fitted(make: Callable[[np.ndarray], Form], start: list[float]) -> Form:
        def off(x: np.ndarray) -> np.ndarray:
            form = make(x)
            parts = [(nominal(form.stress, m, at[m]) - wanted[m]) / np.abs(wanted[m]).max() for m in MODES]
            return np.nan_to_num(np.concatenate(parts), nan=10.0)

        return make(least_squares(off, start, xtol=1e-10, ftol=1e-10).x)

    def reduced(x: np.ndarray) -> Form:
        terms = (((1, 0), 0.5 * G), ((2, 0), G * float(x[0])), ((3, 0), G * float(x[1])))
        return Form(kind="polynomial", bulk=K, terms=terms)

    def mooney(x: np.ndarray) -> Form:
        terms = (((1, 0), 0.5 * G * (1.0 - float(x[0]))), ((0, 1), 0.5 * G * float(x[0])))
        return Form(kind="polynomial", bulk=K, terms=terms)

    def ogden(x: np.ndarray) -> Form:
        return Form(kind="ogden", bulk=K, mu=(2.0 * G / float(x[0]),), alpha=(float(x[0]),))

    yield "fit", fitted(reduced, [0.0, 0.0])
    yield "fit", fitted(mooney, [0.1])
    yield "fit", fitted(ogden, [3.0])
    chains = Form(kind="arruda-boyce", bulk=K, mu=(1.0,), locking=8.0**0.5)
    yield "fit", replace(chains, mu=(G / chains.shear_modulus,))
    yield "fit", Form(kind="polynomial", bulk=K, terms=(((1, 0), 0.5 * G),))
    for kind in ("neo-hookean", "stable-neo-hookean", "st-venant-kirchhoff"):
        yield "fit", Form(kind=kind, bulk=K, mu=(G,))
