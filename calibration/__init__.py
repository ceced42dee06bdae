"""Calibration: photographs and records in, material cards out. SI units; millimetres only in files.

>>> import calibration
>>> experiment = calibration.read_experiment("lab/monday")  # doctest: +SKIP
>>> fits = calibration.fit(experiment, model="neo-hookean", out="calibrations/monday")  # doctest: +SKIP
>>> fits.best("S1").shear_modulus  # doctest: +SKIP
9700.0
>>> print(calibration.diagnose(experiment).sentence)  # doctest: +SKIP
Found: the material creeps: it sinks further with time (creep).

The same as commands: `python -m calibration` lists them.
"""

import sys as _sys
from types import ModuleType as _ModuleType

import lazy_loader as _lazy

# the public names, in __init__.pyi, are imported when first asked for: a command's --help needs none
__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)


class _Package(_ModuleType):
    """The package: `calibration.fit` stays the function where the command module of that name is imported.

    Importing a module binds it to its package; `python -m calibration.fit` and `from calibration.fit import
    app` find the module by its name and need no such binding.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in __all__ and isinstance(value, _ModuleType)):
            super().__setattr__(name, value)


_sys.modules[__name__].__class__ = _Package
