"""The documentation, built from the repository's folder: `python -m sphinx -W -b html -c docs . docs/_build`.

Its source is the whole repository, since the manual, the studies and the benchmarks link to one another;
`include_patterns` says which pages are read. The reference of commands is written from their `--help`, that
of Python from docstrings (`docs/_reference.py`), and the gallery by running `docs/examples`
(sphinx-gallery). Where there is no screen VTK draws with libEGL (Debian: libegl1); without that the example
in PyVista is shown without its picture, and a line says so.
"""

from __future__ import annotations

import os
import sys
from ctypes.util import find_library
from pathlib import Path
from typing import TYPE_CHECKING

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "docs")]

import pyvista  # noqa: E402

import tisim  # noqa: E402

if TYPE_CHECKING:
    from sphinx.application import Sphinx

pyvista.OFF_SCREEN = pyvista.BUILDING_GALLERY = True  # as its scraper asks for
can_draw = sys.platform != "linux" or "DISPLAY" in os.environ or find_library("EGL") is not None
if not can_draw:
    print("docs/examples/plot_vtu.py is not run: VTK finds neither a screen nor libEGL", file=sys.stderr)

project = "tisim"
author = "The tisim authors"
project_copyright = author
version = release = tisim.__version__
root_doc = "docs/index"
language = "en"
default_role = "code"
html_math_renderer = "mathml"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "_mathml",
    "_reference",
]
include_patterns = [
    "docs/**",
    "studies/README.md",
    "studies/**/*.md",
    "studies/**/*.png",
    "benchmarks/README.md",
    "datasets/measured/README.md",
    "datasets/cards/*/card.md",
    "datasets/cards/*/*.png",
    "learn/pretrained/*/card.md",
    "tests/README.md",
    "CHANGELOG.md",
]
exclude_patterns = ["docs/_build", "docs/examples", "**.zarr"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
# the gallery's settings hold functions; types of parameters are words ("path"), no names to look up
suppress_warnings = ["config.cache", "ref.python"]

autosummary_generate = True
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
autodoc_typehints = "none"
napoleon_use_rtype = False

sphinx_gallery_conf = {
    "examples_dirs": str(ROOT / "docs" / "examples"),
    "gallery_dirs": str(ROOT / "docs" / "gallery"),
    "filename_pattern": r"plot_" if can_draw else r"plot_(?!vtu)",
    "image_scrapers": ("matplotlib", "pyvista"),
    "capture_repr": ("_repr_html_",),
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_memory": False,
}

html_theme = "pydata_sphinx_theme"
html_title = "tisim"
html_theme_options = {
    "navigation_with_keys": True,
    "show_toc_level": 1,
    "secondary_sidebar_items": ["page-toc"],
    "header_links_before_dropdown": 6,
}
html_static_path = ["_static"]
html_css_files = ["tables.css"]
html_show_sourcelink = False
html_copy_source = False


def setup(app: Sphinx) -> None:
    """The released surrogate's page is made from its parts, beside the pages."""
    app.connect("build-finished", _write_live_page)


def _write_live_page(app: Sphinx, error: Exception | None) -> None:
    from learn.page.document import Parts

    if error is None and app.builder.name == "html":
        Parts.load(ROOT / "docs" / "live" / "released.zip").write(
            Path(app.outdir) / "docs" / "live" / "poke.html"
        )
