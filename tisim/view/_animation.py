"""The frames of a view as a GIF or MP4, drawn by matplotlib without a display or graphics card."""

from __future__ import annotations

import io
import shutil
import subprocess
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tisim.io.export import checked_path
from tisim.io.picture import Camera, painted, shaded
from tisim.io.whole import whole_file
from tisim.view._view import Array, Surface, View
from tisim.view.page import COLOURS, colour_ranges, drawn_positions

if TYPE_CHECKING:
    from PIL.Image import Image

MOST_PICTURES = 60
TURN = 36  # number of pictures of a view with one frame, which is rotated
REST_AT_END = 1.0  # additional time of the last picture [s]
DPI = 100


def animate(view: View, path: str | Path, *, colour: str | None, seconds: float, width: int) -> Path:
    """See `View.animate`."""
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".gif", ".mp4"):
        raise ValueError(f"{path.name}: expected a name that ends in .gif or .mp4")
    if not (0.1 <= seconds <= 600.0 and 200 <= width <= 2000):
        raise ValueError(
            f"expected 0.1 to 600 s and a width of 200 to 2000 pixels, got {seconds:g} and {width}"
        )
    if colour is not None and colour not in view.colourings:
        known = ", ".join(view.colourings) or "none"
        raise ValueError(f"colour {colour!r}: expected one of {known}")
    checked_path(path)
    ffmpeg = _ffmpeg(path) if ending == ".mp4" else ""
    pictures = list(_pictures(view, colour, width))
    with whole_file(path) as part:
        if ending == ".gif":
            _gif(pictures, part, seconds, turns=len(view.labels) == 1)
        else:
            _mp4(pictures, part, seconds, ffmpeg, name=path.name)
    return path


def _ffmpeg(path: Path) -> str:
    found = shutil.which("ffmpeg")
    if found is not None:
        return found
    try:
        import imageio_ffmpeg
    except ModuleNotFoundError:
        raise ValueError(
            f"{path.name}: an MP4 needs ffmpeg: install it, or pip install 'tisim[video]'; a GIF needs none"
        ) from None
    return str(imageio_ffmpeg.get_ffmpeg_exe())


def _pictures(view: View, colour: str | None, width: int) -> Iterator[Image]:
    """One picture per frame, at most MOST_PICTURES; of a single frame TURN views from all around."""
    count = len(view.labels)
    if count == 1:
        for turn in np.linspace(0.0, 2.0 * np.pi, TURN, endpoint=False):
            yield _picture(view, 0, colour, width, float(turn))
        return
    shown = np.linspace(0, count - 1, min(count, MOST_PICTURES))
    for frame in np.unique(np.round(shown).astype(int)):
        yield _picture(view, int(frame), colour, width, 0.0)


def _picture(view: View, frame: int, colour: str | None, width: int, turn: float) -> Image:
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from PIL import Image

    ranges = colour_ranges(view)
    chosen = colour or next(iter(ranges), None)
    camera = Camera.at(_turned(np.asarray(view.towards), turn))
    scale = Normalize(*ranges[chosen][1]) if chosen is not None else None
    sheets = []
    for surface in view.surfaces:
        if surface.rest or surface.frame not in (None, frame):
            continue
        polygons, values = _drawn(view, surface, frame, chosen)
        if values is None or scale is None:
            faces = np.tile(surface.colour[:3], (len(polygons), 1))
        else:
            faces = colormaps[COLOURS](scale(values))[:, :3]
        sheets.append(shaded(polygons, faces, camera, edges=False))
    flat, faces, edges = painted([s for s in sheets if len(s.polygons)], camera)
    figure = Figure(figsize=(width / DPI, 0.72 * width / DPI), dpi=DPI, layout="constrained")
    axes = figure.add_subplot()
    axes.add_collection(PolyCollection(flat, facecolors=faces, edgecolors=edges, linewidths=0.3))
    axes.set_aspect("equal")
    low, high = _limits(view, camera, all_around=len(view.labels) == 1)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.axis("off")
    size = 11.0 * min(1.0, width / 640.0)
    axes.set_title("\n".join(textwrap.wrap(view.title, max(20, width // 9))), fontsize=size, parse_math=False)
    figure.supxlabel(view.labels[frame], fontsize=size)
    if chosen is not None:
        from matplotlib.cm import ScalarMappable

        field, (least, most) = ranges[chosen]
        under, over = field.values.min() < least, field.values.max() > most
        extend = "both" if under and over else "min" if under else "max" if over else "neither"
        named = f"{field.name} [{field.unit}]" if field.unit else field.name
        bar = ScalarMappable(norm=scale, cmap=colormaps[COLOURS])
        figure.colorbar(bar, ax=axes, label=named, shrink=0.75, pad=0.02, extend=extend)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI)
    buffer.seek(0)
    return Image.open(buffer).convert("RGB")


def _turned(towards: Array, turn: float) -> Array:
    c, s = np.cos(turn), np.sin(turn)
    return np.array([c * towards[0] - s * towards[1], s * towards[0] + c * towards[1], towards[2]])


def _drawn(view: View, surface: Surface, frame: int, chosen: str | None) -> tuple[Array, Array | None]:
    """Triangles (t, 3, 3) [m] at a frame, and the values (t,) of their colours, None without the field."""
    corners = surface.opened if view.opened and surface.opened is not None else surface.triangles
    at = min(frame, len(surface.positions) - 1)
    polygons = surface.positions[at][corners]
    field = next((f for f in surface.fields if f.name == chosen), None)
    return polygons, None if field is None else field.values[at][corners].mean(axis=1)


def _limits(view: View, camera: Camera, *, all_around: bool) -> tuple[Array, Array]:
    """Lower left and upper right corner [mm] of all frames, and rotations if `all_around`, with a margin."""
    points = [p.reshape(-1, 3) for p in drawn_positions(view, rest=False)]
    flat = 1e3 * camera.flat(np.concatenate(points))
    low, high = flat.min(axis=0), flat.max(axis=0)
    if all_around:
        centre = 0.5 * (low + high)
        around = np.concatenate(points)
        reach = 1e3 * np.hypot(*(around[:, :2] - around[:, :2].mean(axis=0)).T).max()
        low[0], high[0] = min(low[0], centre[0] - reach), max(high[0], centre[0] + reach)
    margin = 0.04 * float((high - low).max())
    return low - margin, high + margin


def _gif(pictures: list[Image], path: Path, seconds: float, *, turns: bool) -> None:
    from PIL.Image import Dither

    each = max(20, round(1e3 * seconds / len(pictures)))
    last = each if turns else each + round(1e3 * REST_AT_END)
    palette = _palette()
    small = [picture.quantize(palette=palette, dither=Dither.NONE) for picture in pictures]
    small[0].save(
        path,
        format="GIF",
        save_all=True,
        append_images=small[1:],
        duration=[*[each] * (len(small) - 1), last],
        loop=0,
        optimize=True,
    )


def _palette() -> Image:
    """Palette of the colour map at several brightnesses, and greys."""
    from matplotlib import colormaps
    from PIL import Image

    colours = colormaps[COLOURS](np.linspace(0.0, 1.0, 64))[:, :3]
    greys = np.linspace(0.0, 1.0, 64)[:, None] * np.ones(3)
    every = np.concatenate([*(bright * colours for bright in (1.0, 0.82, 0.66)), greys])
    image = Image.new("P", (1, 1))
    image.putpalette(np.round(255.0 * every).astype(np.uint8).tobytes())
    return image


def _mp4(pictures: list[Image], path: Path, seconds: float, ffmpeg: str, *, name: str) -> None:
    width, height = (side - side % 2 for side in pictures[0].size)
    command: list[Any] = [
        ffmpeg, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}",
        "-framerate", f"{len(pictures) / seconds:.6g}", "-i", "-", "-pix_fmt", "yuv420p", "-r", "30",
        "-movflags", "+faststart", "-f", "mp4", str(path),
    ]  # fmt: skip
    data = b"".join(picture.crop((0, 0, width, height)).tobytes() for picture in pictures)
    ended = subprocess.run(command, input=data, capture_output=True, check=False)
    if ended.returncode != 0:
        said = " ".join(ended.stderr.decode(errors="replace").split())[:200]
        raise ValueError(f"{name}: ffmpeg ended with {said}")
