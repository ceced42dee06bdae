"""Surrogates of simulated pokes: the dataset's loader, models, training, evaluation, prediction.

The package reads the dataset's file format and imports none of the programs that write it.

>>> import learn
>>> predictor = learn.load("runs/quick")
>>> predictor.predict("datasets/scenes/poke.yaml")

The commands are `python -m learn.train`, `learn.evaluate`, `learn.adapt`, `learn.predict`,
`learn.export`, `learn.page` and `learn.bench`.
"""

from importlib import metadata as _metadata

import lazy_loader as _lazy

try:
    __version__ = _metadata.version("tisim")
except _metadata.PackageNotFoundError:  # a checkout that is not installed
    __version__ = "unknown"

# the public names, in __init__.pyi, are imported on first use: a command's --help, and the package
# without torch, need none
__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
