"""The contents of a 3-D view: bodies with fields over frames, a line of text a frame, a curve."""

from __future__ import annotations

import webbrowser
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tisim.io.export import checked_path

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Colour = tuple[float, float, float, float]

STEEL: Colour = (0.55, 0.58, 0.63, 1.0)
REST: Colour = (0.55, 0.60, 0.66, 0.28)

_OUTLINE = {3: (0, 1, 2), 4: (0, 1, 2, 3), 6: (0, 3, 1, 4, 2, 5), 8: (0, 4, 1, 5, 2, 6, 3, 7)}


@dataclass(frozen=True, eq=False, kw_only=True)
class Field:
    """A colouring.

    Attributes
    ----------
    name, unit : str
    values : ndarray, shape (f, n)
        In that unit, by frame and node.
    """

    name: str
    unit: str
    values: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Surface:
    """Triangles that move.

    Attributes
    ----------
    positions : ndarray, shape (f, n, 3)
        [m]; one frame for what does not move.
    triangles : ndarray of int, shape (t, 3)
        Outward.
    edges : ndarray of int, shape (e, 2), optional
        Lines to draw on it: the elements' edges.
    opened, opened_edges : ndarray of int, optional
        The same of the body cut open.
    fields : tuple of Field
        Colourings; the same names for all surfaces of a view that have some. None: it has one colour.
    colour : (float, float, float, float)
        Red, green, blue and opacity, 0 to 1, of what has no fields.
    name : str
        For the key; empty for none.
    rest : bool
        Whether it is the shape at rest, shown on demand.
    frame : int, optional
        The one frame of the view that it belongs to; all where left out.
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
    """A quantity over the frames, (f,) each, drawn below."""

    x: Array
    x_name: str
    x_unit: str
    y: Array
    y_name: str
    y_unit: str


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class View:
    """A picture to turn around, whose frames are stepped through; a notebook shows it.

    Attributes
    ----------
    title : str
    labels : tuple of str
        A line for each frame: where it is, and the force there with its unit.
    surfaces : tuple of Surface
    curve : Curve, optional
    towards : (float, float, float)
        Direction from the body to the viewer at first.
    opened, rest : bool
        Whether bodies are cut open, and shapes at rest shown, at first.
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
        """Names of the colourings there are."""
        return next((tuple(f.name for f in s.fields) for s in self.surfaces if s.fields), ())

    def html(self) -> str:
        """One page that needs no other file and no network."""
        from tisim.view.page import page

        return page(self)

    def save(self, path: str | Path) -> Path:
        """Write the page. FileNotFoundError if the folder does not exist."""
        path = checked_path(path)
        path.write_text(self.html(), encoding="utf-8")
        return path

    def animate(
        self,
        path: str | Path,
        *,
        colour: str | None = None,
        seconds: float = 4.0,
        width: int = 800,
    ) -> Path:
        """Write the frames as a moving picture.

        Parameters
        ----------
        path : path
            Ends in .gif or, where ffmpeg or the package imageio-ffmpeg is at hand, in .mp4.
        colour : str, optional
            One of `colourings`; the first where left out.
        seconds : float
            How long it takes.
        width : int
            [pixels], 200 to 2000.

        Returns
        -------
        Path

        Raises
        ------
        ValueError
            For another ending, a colouring that is not there, or an .mp4 without ffmpeg.
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
        """The page in a frame of its own, for notebooks."""
        style = "width:100%;height:880px;border:0"
        return f'<iframe style="{style}" sandbox="allow-scripts" srcdoc="{escape(self.html())}"></iframe>'


def outlines(facets: Ints) -> Ints:
    """Edges of facets as lines (e, 2), each once."""
    ring = facets[:, _OUTLINE[facets.shape[1]]]
    lines = np.sort(np.stack([ring, np.roll(ring, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    return np.unique(lines[lines[:, 0] != lines[:, 1]], axis=0).astype(np.int32)
