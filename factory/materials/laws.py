"""The parameters of one mixture under each law, as a material card holds them."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from factory.strict_yaml import Strict
from tisim import laws

Modulus = Annotated[float, Field(gt=0, lt=1e12)]
Real = Annotated[float, Field(gt=-1e12, lt=1e12)]
APART = 100.0  # ratio of the moduli of two laws of one card beyond which one has another unit


class Lame(Strict):
    """Lame parameters [Pa]: shear modulus mu, bulk modulus lam + 2 mu / 3."""

    mu: Modulus
    lam: Modulus


class MooneyRivlin(Strict):
    """c10, c01, bulk [Pa]: shear modulus 2 (c10 + c01).

    One of c10 and c01 may be negative, as in some calibrations on moderate strains.
    """

    c10: Real
    c01: Real
    bulk: Modulus

    @model_validator(mode="after")
    def _stiff(self) -> Self:
        if self.c10 + self.c01 <= 0:
            raise ValueError("c10 + c01: expected a positive sum")
        return self


class Ogden(Strict):
    """mu [Pa] and alpha [-], one value per term; bulk [Pa]: shear modulus sum mu alpha / 2."""

    mu: Annotated[tuple[float, ...], Field(min_length=1)]
    alpha: Annotated[tuple[float, ...], Field(min_length=1)]
    bulk: Modulus

    @model_validator(mode="after")
    def _paired(self) -> Self:
        if len(self.mu) != len(self.alpha):
            raise ValueError(f"expected as many mu as alpha, got {len(self.mu)} and {len(self.alpha)}")
        if any(m * a <= 0 for m, a in zip(self.mu, self.alpha, strict=True)):
            raise ValueError("expected mu and alpha of one sign in each term, and not 0")
        return self


class ArrudaBoyce(Strict):
    """mu [Pa], locking stretch [-], bulk [Pa]."""

    mu: Modulus
    locking: Annotated[float, Field(gt=1, lt=1e3)]
    bulk: Modulus


class Laws(Strict):
    """The parameters of one mixture, law by law; those of the neo-Hookean law are required.

    Under a law without parameters a material has the small-strain moduli of the neo-Hookean ones.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, dict[str, float | tuple[float, ...]]]

    st_venant_kirchhoff: Annotated[Lame | None, Field(alias="st-venant-kirchhoff")] = None
    neo_hookean: Annotated[Lame, Field(alias="neo-hookean")]
    stable_neo_hookean: Annotated[Lame | None, Field(alias="stable-neo-hookean")] = None
    mooney_rivlin: Annotated[MooneyRivlin | None, Field(alias="mooney-rivlin")] = None
    ogden: Ogden | None = None
    arruda_boyce: Annotated[ArrudaBoyce | None, Field(alias="arruda-boyce")] = None

    @model_validator(mode="after")
    def _of_one_material(self) -> Self:
        """Moduli of one mixture differ between laws by the error of their fits, not by a unit."""
        base = self.neo_hookean.mu
        for name, parameters in self.model_dump(by_alias=True).items():
            if parameters is None or name not in LAWS:
                continue
            modulus = laws.get(name).moduli(parameters).shear_modulus
            if not 1.0 / APART < modulus / base < APART:
                raise ValueError(
                    f"{name}: its shear modulus is {modulus:g} Pa, and that of neo-hookean {base:g} Pa:"
                    " expected all moduli in Pa"
                )
        return self

    @model_validator(mode="after")
    def _known(self) -> Self:
        for name, parameters in (self.__pydantic_extra__ or {}).items():
            try:
                laws.get(name).check(parameters)
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from None
        return self

    def of(self, law: str) -> dict[str, float | tuple[float, ...]] | None:
        """Parameters under one law; None if the card does not hold them."""
        found = self.model_dump(by_alias=True).get(law)
        return None if found is None else dict(found)


LAWS = tuple(field.alias or name for name, field in Laws.model_fields.items())  # the paper's six
