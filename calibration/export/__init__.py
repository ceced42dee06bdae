"""Material cards for other programs: SOFA, FEBio, Abaqus, CalculiX, MuJoCo, Newton.

A program is a `Target`: which strain energies it has, which parts of a material, and what writes the files. A
whole one, in a file of one's own (a program that has neo-Hookean bodies, and reads them from a line):

>>> from calibration.export import Form, Job, Target, Written, register
>>>
>>> def writes(form, material):
...     return form if form.kind == "neo-hookean" else None
>>>
>>> def write(job, folder):
...     path = folder / "soft.txt"
...     _ = path.write_text(f"neo-hooke {job.form.mu[0]:.6g} {job.form.lam:.6g}")
...     return Written(files={path: "the material"})
>>>
>>> mine = Target(
...     name="my-program",
...     title="My program 1",
...     writes=writes,
...     keeps=lambda material, form: set(),
...     write=write,
... )
>>> _ = register(mine)

From then on `export_card(card, to="my-program", out=folder)` writes it, converts laws that it lacks, and says
what is lost, with its size.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from calibration.export._export import Exported, export_card
    from calibration.export._forms import Form
    from calibration.export._job import Job, Target, Written
    from calibration.export._registry import get, names, register, unregister
    from calibration.export._scene import BeamScene, Prediction
    from calibration.export.command import EXAMPLES, app

__all__ = [
    "EXAMPLES",
    "BeamScene",
    "Exported",
    "Form",
    "Job",
    "Prediction",
    "Target",
    "Written",
    "app",
    "export_card",
    "get",
    "names",
    "register",
    "unregister",
]

# imported when asked for, so that the command's help needs no simulator
_HOME = {
    "EXAMPLES": "command", "app": "command",
    "Exported": "_export", "export_card": "_export", "Form": "_forms",
    "Job": "_job", "Target": "_job", "Written": "_job", "get": "_registry", "names": "_registry",
    "register": "_registry", "unregister": "_registry", "BeamScene": "_scene", "Prediction": "_scene",
}  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
