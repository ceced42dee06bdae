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

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
