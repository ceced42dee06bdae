"""The kinds of scenes and how each is solved: beams, indentation, compression, homogeneous tests, dynamics.

A kind is a registered `SceneKind`. An example of a user's own kind, in a file:

>>> from dataclasses import dataclass, field
>>> import numpy as np
>>> import tisim
>>> from tisim import problems
>>>
>>> @dataclass(frozen=True, kw_only=True)
... class Hydrostat:
...     '''A unit cube under a sequence of volume ratios.'''
...
...     material: tisim.Material
...     ratios: tuple[float, ...] = (0.99,)
...     solver: tisim.Solver = field(default_factory=tisim.Solver)
>>>
>>> def solve(scene, on_step):
...     mesh = tisim.mesh.beam_mesh(length=1.0, section=tisim.Rectangle(width=1.0, height=1.0))
...     F = np.cbrt(scene.ratios)[:, None, None] * np.eye(3)
...     _, stress, _ = tisim.laws.evaluate(scene.material.law, scene.material.parameters, F)
...     n = len(F)
...     return tisim.Result(
...         scene=scene,
...         status=tisim.Status.CONVERGED,
...         mesh=mesh,
...         load=np.array(scene.ratios),
...         positions=F[:, 0, 0, None, None] * mesh.nodes,
...         support_force=np.zeros((n, 3)),
...         min_jacobian=np.array(scene.ratios),
...         residual=np.zeros(n),
...         nominal_stress=stress[:, 0, 0],
...     )
>>>
>>> _ = problems.register(problems.SceneKind(scene=Hydrostat, solve=solve))
>>> soft = tisim.material_from_moduli("neo-hookean", shear_modulus=1e4, bulk_modulus=1e6)
>>> tisim.simulate(Hydrostat(material=soft)).status.value
'converged'
"""

from tisim.problems._checks import check_scene
from tisim.problems._registry import (
    OnStep,
    SceneKind,
    kind_of,
    kinds,
    register,
    register_built_in,
    unregister,
)
from tisim.problems.beam.kind import KIND as BEAM
from tisim.problems.compression.kind import KIND as COMPRESSION
from tisim.problems.homogeneous.kind import KIND as HOMOGENEOUS
from tisim.problems.indentation.kind import KIND as INDENTATION

for _kind in (BEAM, INDENTATION, HOMOGENEOUS, COMPRESSION):
    register_built_in(_kind)

__all__ = ["OnStep", "SceneKind", "check_scene", "kind_of", "kinds", "register", "unregister"]
