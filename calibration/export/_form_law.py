"""A program's strain energy as a law of tisim, for the beam that is expected of the program."""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `_energy` and interprets its annotations)

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from calibration.export._forms import COUPLED, Form
from tisim import laws
from tisim.laws import Law, Moduli, by_invariants, first_isochoric, ti
from tisim.laws._law import scalar, series

NamedLaw = tuple[str, dict[str, float | tuple[float, ...]]]


@ti.func
def _energy(I1, I2, J, prm: ti.template()):  # noqa: ARG001 - one signature for all laws
    """sum c_i (I1bar - 3)^i, with its derivatives by Horner's rule."""
    i1, a = first_isochoric(I1, J)
    n = ti.cast(prm[0], ti.i32)
    w = 0.0
    d = 0.0
    half = 0.0  # of the second derivative
    for k in range(n + 1):
        c = 0.0
        if k < n:
            c = prm[n - k]
        half = half * (i1 - 3.0) + d
        d = d * (i1 - 3.0) + w
        w = w * (i1 - 3.0) + c
    return by_invariants(w, d, 2.0 * half, i1, a, J)


REDUCED_POLYNOMIAL = Law(
    name="export-reduced-polynomial",
    title="reduced polynomial",
    parameters={"c": ("Pa", "series"), "bulk": ("Pa", "scalar")},
    family="invariant",
    theta="log",
    energy=_energy,
    pack=lambda p: (len(series(p, "c")), *series(p, "c")),
    kappa=lambda p: scalar(p, "bulk"),
    moduli=lambda p: Moduli(shear_modulus=2.0 * float(series(p, "c")[0]), bulk_modulus=scalar(p, "bulk")),
    from_moduli=lambda shear, bulk: {"c": (0.5 * shear, 0.05 * shear, 0.01 * shear), "bulk": bulk},
)


@contextmanager
def law_of(form: Form, *, any_volume: bool = False) -> Iterator[NamedLaw | None]:
    """The law of tisim that a form is, with its parameters; None for a form that tisim cannot have.

    A law that tisim itself does not have is registered as long as the context lasts.

    Parameters
    ----------
    form : Form
    any_volume : bool
        Take the form's volumetric energy for K/2 (ln J)^2, to which all are equal at small changes of volume.
    """
    found = as_law(replace(form, volume="log") if any_volume else form)
    if found is not None and found[0] == REDUCED_POLYNOMIAL.name:
        laws.register(REDUCED_POLYNOMIAL)
        try:
            yield found
        finally:
            laws.unregister(REDUCED_POLYNOMIAL.name)
    else:
        yield found


def as_law(form: Form) -> NamedLaw | None:
    """Name and parameters of the law that a form is; None for a form that tisim cannot have."""
    if form.kind in COUPLED:
        return form.kind, {"mu": form.mu[0], "lam": form.lam}
    if form.volume != "log":
        return None
    if form.kind == "ogden":
        return "ogden", {"mu": form.mu, "alpha": form.alpha, "bulk": form.bulk}
    if form.kind == "arruda-boyce":
        return "arruda-boyce", {"mu": form.mu[0], "locking": form.locking, "bulk": form.bulk}
    terms = dict(form.terms)
    if set(terms) <= {(1, 0), (0, 1)}:
        return "mooney-rivlin", {
            "c10": terms.get((1, 0), 0.0),
            "c01": terms.get((0, 1), 0.0),
            "bulk": form.bulk,
        }
    if any(j for _, j in terms):
        return None
    powers = max(i for i, _ in terms)
    c = tuple(terms.get((i, 0), 0.0) for i in range(1, powers + 1))
    return REDUCED_POLYNOMIAL.name, {"c": c, "bulk": form.bulk}
