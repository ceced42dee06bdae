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

import lazy_loader as _lazy

# the public names, in __init__.pyi, are imported when first asked for: a command's --help needs none
__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
