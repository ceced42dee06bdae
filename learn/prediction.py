"""The prediction of one poke: numbers, table, sentences, picture and files."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learn.models import Pokes, Scene
from learn.scene_file import PokeScene
from learn.training.run_folder import write_whole
from learn.verdict import Check, distance_of, grade, verdict

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class AtPoints:
    """The prediction at n points that were asked for. SI units.

    Attributes
    ----------
    names : names of the points; None if they have none.
    points : rest positions on the top face [m], shape (n, 3).
    displacement, radius : as in `PokePrediction`, shapes (n, 3) and (n,).
    """

    names: list[str] | None
    points: Floats
    displacement: NDArray[np.float32]
    radius: Floats | None

    def table(self) -> str:
        """CSV table, in mm."""
        columns = [self.points * 1e3, self.displacement * 1e3]
        heads = "x_mm,y_mm,z_mm,ux_mm,uy_mm,uz_mm"
        if self.radius is not None:
            columns, heads = [*columns, self.radius[:, None] * 1e3], f"{heads},radius_mm"
        out = io.StringIO()
        write = csv.writer(out, lineterminator="\n")
        write.writerow([*(["id"] if self.names else []), *heads.split(",")])
        for k, row in enumerate(np.concatenate(columns, axis=1)):
            write.writerow([*([self.names[k]] if self.names else []), *(f"{value:.6g}" for value in row)])
        return out.getvalue()


@dataclass(frozen=True, eq=False, kw_only=True)
class PokePrediction:
    """The prediction of one poke. SI units.

    Attributes
    ----------
    poke : the requested poke.
    points : rest positions of the surface's points [m], shape (n, 3).
    displacement : displacement of these points [m], shape (n, 3).
    force : magnitude of the force on the indenter [N].
    radius : radius of the 90 % interval at each point [m], shape (n,); None without intervals.
    force_interval : 90 % interval of the force [N]; None without intervals, and for a predicted force that is
        0 or less, as model cegnn may have it, around which no factor makes an interval.
    checks : comparison of each quantity with its trained range.
    scene, pokes : the model's input.
    asked : prediction at the points that were asked for; None if there were none.
    """

    poke: PokeScene
    points: Floats
    displacement: NDArray[np.float32]
    force: float
    radius: Floats | None
    force_interval: tuple[float, float] | None
    checks: list[Check]
    scene: Scene
    pokes: Pokes
    asked: AtPoints | None = None

    @property
    def inside(self) -> bool | None:
        """True if the poke is inside the domain of validity; None if that is not known."""
        if any(check.inside is False for check in self.checks):
            return False
        return None if all(check.inside is None for check in self.checks) else True

    @property
    def distance(self) -> float:
        """Distance from the trained ranges (`learn.validity.Domain.distance`), 0 inside; NaN if not known."""
        return distance_of(self.checks)

    @property
    def outside(self) -> list[Check]:
        """Checks of the quantities outside the domain of validity."""
        return [check for check in self.checks if check.inside is False]

    @property
    def verdict(self) -> str:
        """The domain of validity in words (`learn.verdict`)."""
        return verdict(self.checks, intervals=self.radius is not None)

    def as_dict(self) -> dict[str, Any]:
        """The numbers of prediction.json."""
        size = np.linalg.norm(self.displacement, axis=1)
        answer: dict[str, Any] = {
            "force_N": self.force,
            "largest_displacement_mm": float(size.max() * 1e3),
        }
        if self.force_interval is not None:
            low, high = self.force_interval
            answer |= {"force_low_N": low, "force_high_N": high}
        if self.radius is not None:
            answer |= {"radius_mean_mm": float(self.radius.mean() * 1e3)}
            answer |= {"radius_max_mm": float(self.radius.max() * 1e3)}
        answer["inside_training"] = self.inside
        if self.inside is not None:
            answer["distance_from_training"] = self.distance
        answer["domain"] = {
            check.key: {
                "value": check.value,
                "trained": check.trained,
                "inside": check.inside,
                "beyond": check.beyond,
            }
            for check in self.checks
        }
        return answer

    def save(self, folder: Path | str) -> Path:
        """Write displacement.csv, prediction.json, prediction.png, and points.csv if points were asked for.

        All are made before the first is written, so that a fault leaves an earlier prediction as it was.
        """
        folder = Path(folder)
        grid = AtPoints(names=None, points=self.points, displacement=self.displacement, radius=self.radius)
        rows, picture = grid.table(), io.BytesIO()
        asked = None if self.asked is None else self.asked.table()
        text = json.dumps(self.as_dict(), indent=1, allow_nan=False) + "\n"
        self.picture().savefig(picture, format="png", dpi=110)
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(folder / "displacement.csv", rows.encode())
        if asked is not None:
            write_whole(folder / "points.csv", asked.encode())
        else:
            (folder / "points.csv").unlink(missing_ok=True)  # of an earlier prediction
        write_whole(folder / "prediction.json", text.encode())
        write_whole(folder / "prediction.png", picture.getvalue())
        return folder

    def picture(self) -> Any:
        """A matplotlib figure: the cut along the push with the indenter, and the displacement from above."""
        from learn.evaluation.pictures import draw_prediction  # matplotlib: half a second to import

        where = "not known whether inside"
        if self.inside is not None:
            where = "inside" if self.inside else grade(self.distance).upper()
        title = f"force {self._force_text}, {where} the trained ranges"
        marks = None if self.asked is None else self.asked.points
        return draw_prediction(
            self.scene, self.pokes, self.displacement, radius=self.radius, title=title, marks=marks
        )

    @property
    def _force_text(self) -> str:
        if self.force_interval is None:
            why = "" if self.radius is None else " (no interval: it is 0 N or less)"
            return f"{self.force:.3g} N{why}"
        low, high = self.force_interval
        return f"{self.force:.3g} N (90 %: {low:.3g} to {high:.3g})"

    def __repr__(self) -> str:
        largest = float(np.linalg.norm(self.displacement, axis=1).max() * 1e3)
        return (
            f"PokePrediction(force {self._force_text}, largest displacement {largest:.3g} mm; {self.verdict})"
        )

    def _repr_html_(self) -> str:
        from learn.evaluation.pictures import encoded

        rows = [
            ("force", self._force_text),
            ("", self.verdict),
            *((c.name, c.value_text) for c in self.checks),
        ]
        return f'{html_table(rows)}<img src="data:image/png;base64,{encoded(self.picture())}">'


def html_table(rows: Sequence[tuple[str, str]]) -> str:
    cells = "".join(f"<tr><th>{escape(key)}</th><td>{escape(value)}</td></tr>" for key, value in rows)
    return f"<table>{cells}</table>"
