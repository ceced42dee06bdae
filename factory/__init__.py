"""Datasets of simulated pokes: planned from a recipe, built, resumed, read and verified.

>>> import factory
>>> from pathlib import Path
>>> plan = factory.make_plan(factory.load_recipe("quick"), "ogden")
>>> plan
Plan(quick, ogden: 12 pokes = 2 shapes x 3 material levels x 2)
>>> built = factory.build_dataset(plan, Path("datasets/quick-ogden.zarr"))        # doctest: +SKIP
>>> factory.open_dataset("datasets/quick-ogden.zarr").poke(3).rod_force           # doctest: +SKIP

The commands are `python -m factory.build`, `.inspect`, `.verify`, `.card` and `.release`. `build_dataset`
takes a callback `on_progress`; other events are logged under "factory". Errors that users can
correct are `InputError`.
"""

import lazy_loader as _lazy

# the public names, in __init__.pyi, are imported on first use: a command's --help needs none
__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
