"""From a result or a file to a view."""

from __future__ import annotations

from pathlib import Path

from tisim.result import Result
from tisim.view._files import view_of_files
from tisim.view._result import view_of_result
from tisim.view._view import View


def show(result: Result, path: str | Path | None = None, *, title: str | None = None) -> View:
    """A result to turn around: frames to step through, the rod, forces, coloured by displacement or stress.

    Parameters
    ----------
    result : Result
    path : path, optional
        Write the page there.
    title : str, optional
        Instead of a line that describes the scene.

    Returns
    -------
    View
        A notebook shows it; `View.save` writes the page, `View.animate` a GIF or MP4.

    Raises
    ------
    ValueError
        For a result without a frame.
    FileNotFoundError
        If the page's folder does not exist.
    """
    view = view_of_result(result, title=title)
    if path is not None:
        view.save(path)
    return view


def view_of_file(path: str | Path, *more: str | Path, poke: int | None = None) -> View:
    """Contents of a file as a view, see `python -m tisim.view --help`.

    Parameters
    ----------
    path, *more : path
        A .vtu or several, one a frame; a .pvd, which names some; a dataset's store (.zarr, .zarr.zip).
    poke : int, optional
        Which poke of a store, by its index.

    Returns
    -------
    View

    Raises
    ------
    ValueError
        In one sentence, for what cannot be shown.
    FileNotFoundError
        If there is no such file.
    """
    return view_of_files([Path(path), *map(Path, more)], poke=poke)
