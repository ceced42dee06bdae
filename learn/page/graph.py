"""Computation of a page at every frame as one ONNX graph: network, domain of validity, intervals.

It equals `learn.real_time.RealTime` (checked by `tests/learn/page`), except that the codes of the interior
are inputs: the page does not contain the encoder. The page's JavaScript repeats none of this computation.

Inputs, SI units, of one poke over one interior:

- poke (6,), float64: site x, y [m]; angle between push and vertical, heading of its horizontal part [rad];
  depth [m]; shear modulus [Pa];
- base, looked, vectors, clear, layers, soft, about: the interior (`interior_inputs`).

Outputs: displacement (n, 3) [m], force () [N], tip (3,) [m] at first contact, direction (3,) of the push.
If the domain is known: values (q,) and beyond (q + 1,), in the order of `QUANTITIES` with the kind of
inclusion last, and distance (). If the run has intervals: factor () of the force's 90 % interval, and
radius (n,) [m].
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from learn.data import Setup
from learn.evaluation import Intervals
from learn.evaluation.intervals import FORCE_UNKNOWN, LEAST_DEPTH, LENGTH
from learn.metrics import RING_EDGES_MM
from learn.models import InvariantGnn, Scene
from learn.models._encoder import Stencil
from learn.onnx_bundle import need_packages, write_graph
from learn.page.network import RowNetwork, interior_codes
from learn.quantities import NEAR, QUANTITIES, interior_of
from learn.validity import RELATIVE_SLACK, Domain, unit_of

INPUTS = ["poke", "base", "looked", "vectors", "clear", "layers", "soft", "about"]
_FAR = 1e30  # limit of a range on a side that is not checked

Inputs = dict[str, NDArray[np.float32] | NDArray[np.float64]]


def interior_inputs(
    model: InvariantGnn,
    scene: Scene,
    stencils: tuple[Stencil, ...],
    profile: NDArray[np.uint8],
    setup: Setup,
    *,
    trained_kind: bool,
) -> Inputs:
    """Inputs of the graph that depend on the interior alone.

    Parameters
    ----------
    scene, stencils : scene of the setup's points, and the result of `model.prepare`.
    profile : stiffness under each point as stored, shape (n, levels).
    trained_kind : False if this kind of inclusion was not trained on.

    Returns
    -------
    base, looked, vectors, clear, layers: see `learn.page.network.interior_codes`; soft (n,): thickness of the
    soft tissue above the inclusion [m]; about (4,): width and height of the inclusion [mm], 1 for a kind that
    was not trained, size of the inclusion [mm] (`learn.quantities.Interior`).
    """
    rigid = torch.from_numpy(profile == 255).float()
    with torch.no_grad():
        one = replace(scene, rigid=rigid[None], rigid_index=torch.zeros(1, dtype=torch.int64))
        codes = interior_codes(model, model.encode(one, stencils))
    inside = interior_of(setup, profile)
    return {
        **{name: code.numpy() for name, code in codes.items()},
        "soft": inside.soft.astype(np.float64),
        "about": np.array([inside.width, inside.height, 0.0 if trained_kind else 1.0, inside.size]),
    }


class PagePart(nn.Module):
    """One poke with plain tensors as inputs and outputs; see the module."""

    def __init__(
        self,
        model: InvariantGnn,
        scene: Scene,
        stencils: tuple[Stencil, ...],
        setup: Setup,
        domain: Domain | None,
        intervals: Intervals | None,
    ) -> None:
        super().__init__()
        self.network = RowNetwork(model, scene, stencils)
        self.points = torch.from_numpy(setup.points)
        self.radius, self.edge = setup.rod_radius, setup.rod_edge
        # a tensor, since the exporter fills arrays with single precision
        self.top = torch.tensor(setup.top, dtype=torch.float64)
        self.middle = torch.from_numpy(setup.middle)
        lengths = [1e3 * v for v in (self.radius, self.edge, *setup.block_size)]
        self.lengths = torch.tensor(lengths, dtype=torch.float64)
        self.reach = torch.tensor(setup.block_size[:2], dtype=torch.float64) / 2
        self.level = setup.block_size[2] / len(setup.level_depth)
        self.ranges = None if domain is None else _Ranges(domain)
        self.intervals = intervals
        if intervals is not None:
            self.scale = torch.tensor(intervals.scale, dtype=torch.float64)
            self.factors = torch.tensor(intervals.factors, dtype=torch.float64)
            self.rings = torch.tensor(RING_EDGES_MM[1:-1], dtype=torch.float64)
            self.growth = torch.tensor(intervals.growth, dtype=torch.float64)
            self.force_growth = torch.tensor(intervals.force_growth, dtype=torch.float64)

    def outputs(self) -> list[str]:
        """Names of the outputs of `forward`."""
        names = ["displacement", "force", "tip", "direction"]
        names += ["values", "beyond", "distance"] if self.ranges is not None else []
        return names + (["factor", "radius"] if self.intervals is not None else [])

    def forward(
        self,
        poke: Tensor,
        base: Tensor,
        looked: Tensor,
        vectors: Tensor,
        clear: Tensor,
        layers: Tensor,
        soft: Tensor,
        about: Tensor,
    ) -> tuple[Tensor, ...]:
        x, y, angle, heading, depth, modulus = poke.unbind(0)
        sine, cosine = torch.sin(angle), torch.cos(angle)
        push = torch.stack([sine * torch.cos(heading), sine * torch.sin(heading), -cosine])
        # as in `learn.data.Setup.first_touch`
        above = self.edge * (1 - cosine) + (self.radius - self.edge) * sine
        tip = torch.stack([x, y, self.top]) - push * (above / cosine)
        u, force = self.network(base, looked, vectors, clear, layers, tip, push, depth, modulus)
        found = [u, force, tip, push]
        distance = torch.zeros_like(depth)
        if self.ranges is not None:
            values = self._values(poke, soft, about)
            beyond, distance = self.ranges(values, about[2])
            found += [values, beyond, distance]
        if self.intervals is not None:
            deep = depth.clamp(min=0.0)
            gap = 1e3 * self._gap(tip + deep * push, soft)
            covariates = torch.stack([about[3], gap, angle * (180 / math.pi)])
            found += self._intervals(u.double(), tip, deep, covariates, distance)
        return tuple(found)

    def _values(self, poke: Tensor, soft: Tensor, about: Tensor) -> Tensor:
        """The quantities of `learn.quantities.poke_values`, in their order."""
        site, angle, depth, modulus = poke[:2], poke[2], poke[4], poke[5]
        cover = self._cover(poke, soft)
        to_side = (self.reach - (site - self.middle).abs()).min()
        values = {
            "depth_mm": depth * 1e3,
            "angle_deg": angle * (180 / math.pi),
            "cover_mm": cover * 1e3,
            "depth_over_cover": depth * torch.cos(angle) / cover.clamp(min=self.level),
            "shear_modulus_kPa": modulus * 1e-3,
            "rod_radius_mm": self.lengths[0],
            "rod_edge_mm": self.lengths[1],
            "block_x_mm": self.lengths[2],
            "block_y_mm": self.lengths[3],
            "block_z_mm": self.lengths[4],
            "site_to_side_mm": to_side * 1e3,
            "inclusion_width_mm": about[0],
            "inclusion_height_mm": about[1],
        }
        return torch.stack([values[key] for key in QUANTITIES])

    def _cover(self, poke: Tensor, soft: Tensor) -> Tensor:
        """Least thickness of the soft tissue near the site [m]."""
        away = torch.sqrt((self.points[:, :2] - poke[:2]).square().sum(dim=1))
        near = away <= away.min().clamp(min=self.radius)
        return torch.where(near, soft, torch.full_like(soft, _FAR)).min()

    def _gap(self, tip: Tensor, soft: Tensor) -> Tensor:
        """Distance from the indenter's tip to what is rigid [m], as `learn.quantities.gap_mm`."""
        x, y, z = self.points.unbind(1)
        below = (tip[2] - (z - soft)).clamp(min=0.0)
        square = (x - tip[0]).square() + (y - tip[1]).square() + below * below
        return torch.sqrt(square.min()).clamp(max=NEAR)

    def _intervals(
        self, u: Tensor, tip: Tensor, depth: Tensor, covariates: Tensor, distance: Tensor
    ) -> list[Tensor]:
        """Factor around the force and radius at each point [m], as `learn.evaluation.Intervals` has them."""
        assert self.intervals is not None
        away = torch.sqrt((self.points - tip).square().sum(dim=1))
        size = torch.sqrt(u.square().sum(dim=1))
        least = depth.clamp(min=LEAST_DEPTH)
        far, deep = torch.log1p(away / 2.5e-3), torch.log(least / 5e-3).expand_as(away)
        moved = torch.log(size / least + 1e-4)
        parts = [torch.ones_like(far), far, far * far, far * far * far, deep, deep * deep, deep * far]
        logs = torch.stack([*parts, moved, moved * moved], dim=1) @ self.scale
        logs = logs + covariates @ self.growth
        ring = (away[:, None] * 1e3 >= self.rings).sum(dim=1)
        # not -expm1(-t), which no runtime has in double: the digits lost at small t are negligible
        unknown = 1 - torch.exp(-((distance / LENGTH) ** 2))
        inside = self.factors[ring] * torch.exp(logs)
        radius = torch.sqrt(inside.square() + unknown * (1e3 * size).square()) * 1e-3
        radius = torch.minimum(radius, size + depth)
        fitted = self.intervals.force_scale * torch.exp(covariates @ self.force_growth)
        log = torch.sqrt((self.intervals.force * fitted) ** 2 + unknown * FORCE_UNKNOWN**2)
        return [torch.exp(log), radius]


class _Ranges(nn.Module):
    """`learn.validity.Domain` as a module: excess of each quantity over its range, and their norm."""

    def __init__(self, domain: Domain) -> None:
        super().__init__()
        low, high, slack, width = [], [], [], []
        for key, quantity in QUANTITIES.items():
            a, b = domain.ranges.get(key, (-_FAR, _FAR))
            known = key in domain.ranges
            largest = max(abs(a), abs(b))
            low.append(a if quantity.sides != "high" else -_FAR)
            high.append(b if quantity.sides != "low" else _FAR)
            slack.append(quantity.slack + RELATIVE_SLACK * largest if known else 0.0)
            width.append(unit_of(key, a, b) if known else _FAR)
        self.low, self.high, self.slack, self.width = (
            torch.tensor(column, dtype=torch.float64) for column in (low, high, slack, width)
        )

    def forward(self, values: Tensor, kind: Tensor) -> tuple[Tensor, Tensor]:
        """Excess (q + 1,) in widths of the ranges, 0 inside, the kind last; and its norm without the kind."""
        excess = torch.maximum(self.low - values, values - self.high) - self.slack
        beyond = excess.clamp(min=0.0) / self.width
        return torch.cat([beyond, kind[None]]), torch.sqrt(beyond.square().sum())


def write_page_graph(part: PagePart, example: Inputs, path: Path) -> None:
    """Write the graph as an ONNX file; `example` holds the inputs of any interior."""
    need_packages()
    poke = torch.tensor([0.0, 0.0, 0.1, 0.3, 5e-3, 1e4], dtype=torch.float64)
    inputs = (poke, *(torch.from_numpy(example[name]) for name in INPUTS[1:]))
    write_graph(part, inputs, path, INPUTS, part.outputs(), simplify=False)
