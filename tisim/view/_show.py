"""Views of results and of files."""

from __future__ import annotations

from pathlib import Path

from tisim.result import Result
from tisim.view._files import view_of_files
from tisim.view._result import view_of_result
from tisim.view._view import View


def show(result: Result, path: str | Path | None = None, *, title: str | None = None) -> View:
    """Interactive view of a result: its frames, the rod, forces, and colours by displacement or stress.

    Parameters
    ----------
    result : Result
    path : path, optional
        File to which to write the page.
    title : str, optional
        Title; by default a line that describes the scene.

    Returns
    -------
    View
        A notebook displays it; `View.save` writes the page, `View.animate` a GIF or MP4.

    Raises
    ------
    ValueError
        If the result has no frame.
    FileNotFoundError
        If the page's folder does not exist.
    """
    view = view_of_result(result, title=title)
    if path is not None:
        view.save(path)
    return view


def view_of_file(path: str | Path, *more: str | Path, poke: int | None = None) -> View:
    """View of a file's contents, as by `python -m tisim.view`.

    Parameters
    ----------
    path, *more : path
        One .vtu or several, one per frame; a .pvd series; or a dataset's store (.zarr, .zarr.zip).
    poke : int, optional
        Index of a poke of a store; by default the first that was simulated.

    Returns
    -------
    View

    Raises
    ------
    ValueError
        If the contents cannot be shown; the message is one sentence.
    FileNotFoundError
        If there is no such file.
    """
    return view_of_files([Path(path), *map(Path, more)], poke=poke)
