"""The contents of a 3-D view: bodies with fields over frames, a line of text per frame, a curve."""

from __future__ import annotations

import webbrowser
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tisim.io.export import checked_path
from tisim.io.whole import write_whole
from tisim.mesh import FACET_OUTLINE

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Colour = tuple[float, float, float, float]

STEEL: Colour = (0.55, 0.58, 0.63, 1.0)
REST: Colour = (0.55, 0.60, 0.66, 0.28)


@dataclass(frozen=True, eq=False, kw_only=True)
class Field:
    """A field by which a surface is coloured.

    Attributes
    ----------
    name, unit : str
        Name and unit for display.
    values : ndarray, shape (f, n)
        Values in that unit, by frame and node.
    """

    name: str
    unit: str
    values: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Surface:
    """A moving surface of triangles.

    Attributes
    ----------
    positions : ndarray, shape (f, n, 3)
        Positions [m]; one frame for a fixed surface.
    triangles : ndarray of int, shape (t, 3)
        Node indices, outward.
    edges : ndarray of int, shape (e, 2), optional
        Lines to draw on it: the elements' edges.
    opened, opened_edges : ndarray of int, optional
        Triangles and lines of the body cut open.
    fields : tuple of Field
        Fields for colours, with the same names for all surfaces of a view that have fields. If empty, the
        surface has one colour.
    colour : (float, float, float, float)
        Red, green, blue and opacity, 0 to 1, of a surface without fields.
    name : str
        Name in the legend; empty for none.
    rest : bool
        True for the rest shape, which is shown on demand.
    frame : int, optional
        The only frame of the view that shows it; by default all do.
    """

    positions: Array
    triangles: Ints
    edges: Ints | None = None
    opened: Ints | None = None
    opened_edges: Ints | None = None
    fields: tuple[Field, ...] = ()
    colour: Colour = STEEL
    name: str = ""
    rest: bool = False
    frame: int | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """A curve over the frames, drawn below the picture: x and y (f,) with names and units."""

    x: Array
    x_name: str
    x_unit: str
    y: Array
    y_name: str
    y_unit: str


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class View:
    """An interactive 3-D view with frames; a notebook displays it.

    Attributes
    ----------
    title : str
    labels : tuple of str
        A line for each frame with the load parameter and the force, in their units.
    surfaces : tuple of Surface
    curve : Curve, optional
    towards : (float, float, float)
        Initial direction from the body to the viewer.
    opened, rest : bool
        True if bodies are initially cut open, and rest shapes initially shown.
    notes : tuple of str
        Sentences below the picture.
    """

    title: str
    labels: tuple[str, ...]
    surfaces: tuple[Surface, ...]
    curve: Curve | None = None
    towards: tuple[float, float, float] = (0.35, -1.0, 0.45)
    opened: bool = False
    rest: bool = False
    notes: tuple[str, ...] = field(default_factory=tuple)

    def __repr__(self) -> str:
        count = len(self.labels)
        return f"<View of {self.title}: {count} frame{'s' if count != 1 else ''}; .save(path) writes a page>"

    @property
    def colourings(self) -> tuple[str, ...]:
        """Names of the fields by which the view can be coloured."""
        return next((tuple(f.name for f in s.fields) for s in self.surfaces if s.fields), ())

    def html(self) -> str:
        """A self-contained HTML page, which needs no other file and no network."""
        from tisim.view.page import page

        return page(self)

    def save(self, path: str | Path) -> Path:
        """Write the page, whole or not at all; FileNotFoundError if the folder does not exist."""
        return write_whole(checked_path(path), self.html())

    def animate(
        self,
        path: str | Path,
        *,
        colour: str | None = None,
        seconds: float = 4.0,
        width: int = 800,
    ) -> Path:
        """Write the frames as an animation.

        Parameters
        ----------
        path : path
            A file that ends in .gif or, if ffmpeg or the package imageio-ffmpeg is installed, in .mp4.
        colour : str, optional
            One of `colourings`; by default the first.
        seconds : float
            Duration [s], 0.1 to 600, without the additional time of a GIF's last frame.
        width : int
            Width [pixels], 200 to 2000.

        Returns
        -------
        Path

        Raises
        ------
        ValueError
            For another ending, an unknown colouring, arguments out of range, or an .mp4 without ffmpeg.
        FileNotFoundError
            If the folder does not exist.
        """
        from tisim.view._animation import animate

        return animate(self, path, colour=colour, seconds=seconds, width=width)

    def open(self, path: str | Path = "view.html") -> Path:
        """Write the page and open it in a browser."""
        path = self.save(path)
        webbrowser.open(path.resolve().as_uri())
        return path

    def _repr_html_(self) -> str:
        """The page in an iframe, for notebooks."""
        style = "width:100%;height:880px;border:0"
        return f'<iframe style="{style}" sandbox="allow-scripts" srcdoc="{escape(self.html())}"></iframe>'


def outlines(facets: Ints) -> Ints:
    """Distinct edges of facets as lines (e, 2), with the halves of edges that have a middle node."""
    ring = facets[:, FACET_OUTLINE[facets.shape[1]]]
    lines = np.sort(np.stack([ring, np.roll(ring, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    return np.unique(lines[lines[:, 0] != lines[:, 1]], axis=0).astype(np.int32)
