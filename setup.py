"""Puts the recipes and material cards of datasets/ into the built package, as factory/_shipped/.

All else about the distribution is in pyproject.toml. An editable install reads datasets/ itself.
"""

from __future__ import annotations

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

SHIPPED = {"recipes": "*.yaml", "materials": "*.yaml"}  # folders of datasets/, and what of them is shipped


class BuildWithRecipes(build_py):
    """`build_py` that also copies what `factory.bundled.shipped_folder` looks for."""

    def run(self) -> None:
        super().run()
        if self.editable_mode:
            return
        for folder, pattern in SHIPPED.items():
            target = Path(self.build_lib, "factory", "_shipped", folder)
            target.mkdir(parents=True, exist_ok=True)
            for source in sorted(Path("datasets", folder).glob(pattern)):
                self.copy_file(str(source), str(target / source.name))


setup(cmdclass={"build_py": BuildWithRecipes})
