"""Rigid inclusions of a soft block: the registered shapes, and how to add one.

A shape is a registered frozen dataclass that derives from `Inclusion`:

>>> from dataclasses import dataclass
>>> import numpy as np
>>> from tisim import inclusions
>>>
>>> @dataclass(frozen=True, kw_only=True)
... class SpheroidInclusion(inclusions.Inclusion):
...     '''Rigid spheroid: equatorial radius, half its height, centre [m].'''
...
...     kind = "spheroid"
...     radius: float
...     half_height: float
...
...     def mesh_geometry(self):
...         return inclusions.Spheroid(radius=self.radius, half_height=self.half_height)
...
...     def signed_distance(self, points):  # to first order in the distance
...         p = (np.asarray(points) - self.centre) / (self.radius, self.radius, self.half_height)
...         size = np.linalg.norm(p, axis=-1)
...         return (size - 1.0) * min(self.radius, self.half_height)
...
...     @property
...     def extent(self):
...         return (self.radius, self.radius, self.half_height)
...
...     @property
...     def volume(self):
...         return 4.0 / 3.0 * np.pi * self.radius**2 * self.half_height
>>>
>>> _ = inclusions.register(
...     SpheroidInclusion,
...     recipe=inclusions.RecipeShape(
...         name="spheroid",
...         parameters=(inclusions.RecipeParameter("radius"), inclusions.RecipeParameter("half_height")),
...         standing=lambda p, x, y, angle: SpheroidInclusion(
...             radius=p["radius"], half_height=p["half_height"], centre=(x, y, p["half_height"])
...         ),
...     ),
... )

After this it can be used in blocks, in the mesh of a poke, and in recipes of datasets. A built-in shape is a
file in this folder and a line at the end of this one.
"""

from __future__ import annotations

from tisim._checks import FieldError
from tisim.inclusions import box, cylinder, sphere
from tisim.inclusions._recipe import RecipeParameter, RecipeShape
from tisim.inclusions._registry import decode, from_dimensions, get, kinds, recipe_shapes, register
from tisim.inclusions._shape import Inclusion, MeshGeometry, Prism, Spheroid, Vector
from tisim.inclusions.box import BoxInclusion
from tisim.inclusions.cylinder import CylinderInclusion
from tisim.inclusions.sphere import SphereInclusion

__all__ = [
    "BoxInclusion",
    "CylinderInclusion",
    "FieldError",
    "Inclusion",
    "MeshGeometry",
    "Prism",
    "RecipeParameter",
    "RecipeShape",
    "SphereInclusion",
    "Spheroid",
    "Vector",
    "decode",
    "from_dimensions",
    "get",
    "kinds",
    "recipe_shapes",
    "register",
]

register(BoxInclusion, recipe=box.RECIPE)
register(SphereInclusion, recipe=sphere.RECIPE)
register(CylinderInclusion, recipe=cylinder.RECIPE)
