"""Results of the Python interface: fits, a diagnosis, a reconstruction, each printed well in a notebook."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from html import escape
from math import hypot
from pathlib import Path
from typing import TYPE_CHECKING, Any

from calibration._files import write_whole
from calibration.errors import InputError
from calibration.experiment.model import Experiment
from calibration.progress import log
from calibration.study.calibration import Calibration
from calibration.study.cards import best, usable, write_card

if TYPE_CHECKING:
    from calibration.diagnosis import Diagnosis
    from calibration.prediction import Prediction


@dataclass(frozen=True, eq=False, repr=False)
class Fits(Sequence[Calibration]):
    """Calibrations of an experiment, one a material and law, in the order in which they were asked for.

    Attributes
    ----------
    results : tuple of Calibration
    experiment : Experiment
        As fitted, with the rig's corrections where a rig was given.
    folder : Path, optional
        Folder of the fits; None for fits that were made in memory.
    """

    results: tuple[Calibration, ...]
    experiment: Experiment
    folder: Path | None = None

    def __len__(self) -> int:
        return len(self.results)

    def __getitem__(self, index: Any) -> Any:
        return self.results[index]

    def __iter__(self) -> Iterator[Calibration]:
        return iter(self.results)

    @property
    def materials(self) -> tuple[str, ...]:
        """Materials that were fitted."""
        return tuple(dict.fromkeys(r.material for r in self.results))

    @property
    def converged(self) -> bool:
        """True if every fit is a calibration: converged, and without a lack of fit."""
        return all(r.status == "converged" for r in self.results)

    def of(self, material: str) -> tuple[Calibration, ...]:
        """All laws of one material."""
        return tuple(r for r in self.results if r.material == material)

    def best(self, material: str) -> Calibration:
        """The law of a material with the lowest Akaike value.

        Raises
        ------
        InputError
            No law has a finished fit.
        """
        chosen = best(self.of(material))
        if chosen is None:
            raise InputError(f"material {material}: expected a finished fit of at least one law")
        return chosen

    @property
    def headlines(self) -> tuple[str, ...]:
        """A sentence a material: its shear modulus, or what its data ask for that the laws lack."""
        from calibration.report import headline

        return tuple(headline(self.of(m), self.experiment) for m in self.materials)

    def write_cards(self, folder: str | Path) -> list[Path]:
        """Write folder/MATERIAL.yaml for each material that has a finished fit; their paths.

        A material without one gets no card, and a warning in the log "calibration" says so: a card that an
        earlier run left in the folder stays there, and would be taken for this one's.
        """
        written = []
        for name in self.materials:
            own, path = self.of(name), Path(folder) / f"{name}.yaml"
            if any(usable(r) for r in own):
                written.append(write_card(Path(folder), own, self.experiment))
            else:
                left = f"; {path} is an earlier run's" if path.exists() else ""
                log.warning("%s: no card, since no law has a finished fit%s", name, left)
        return written

    def write_report(self, folder: str | Path) -> Path:
        """Write folder/report.html and its pictures; the path of the page."""
        from calibration.report import write_page

        Path(folder).mkdir(parents=True, exist_ok=True)
        return write_page(Path(folder), self.results, self.experiment)

    def __repr__(self) -> str:
        lines = [f"Fits of {self.experiment.name!r}: {len(self)}", *(f"  {h}" for h in self.headlines)]
        return "\n".join([*lines, *(f"  {r!r}" for r in self.results)])

    def _repr_html_(self) -> str:
        head = ("material", "law", "status", "G / kPa", "reduced χ²")
        rows = [
            (
                r.material,
                r.label,
                r.status,
                _number(r.shear_modulus / 1e3, r.shear_modulus_sd / 1e3),
                _number(r.reduced_chi2),
            )
            for r in self.results
        ]
        return "".join(f"<p>{escape(h)}</p>" for h in self.headlines) + _html_table(head, rows)


@dataclass(frozen=True, eq=False, repr=False)
class DiagnosisResult:
    """A diagnosis of an experiment.

    Attributes
    ----------
    diagnosis : calibration.diagnosis.Diagnosis
        Everything that was found.
    experiment : Experiment
    model : object
        The measurement model that was diagnosed (its pictures are drawn from it).
    """

    diagnosis: Diagnosis
    experiment: Experiment
    model: Any = field(repr=False)

    @property
    def sentence(self) -> str:
        """The verdict."""
        return self.diagnosis.sentence()

    @property
    def verdict(self) -> str:
        """One of none, found, ambiguous, partly explained and unexplained."""
        return str(self.diagnosis.finding.verdict)

    @property
    def causes(self) -> list[dict[str, Any]]:
        """Effects of the explanation that is named, with their parameters and standard deviations."""
        return self.diagnosis.causes()

    @property
    def baseline_converged(self) -> bool:
        """True if the fit without any effect converged."""
        return bool(self.diagnosis.finding.baseline.converged)

    def write(self, folder: str | Path) -> Path:
        """Write report.html, pictures, cards and, last, diagnosis.json; the path of the page.

        A folder with a diagnosis.json is complete: that of an earlier diagnosis is removed first.
        """
        from calibration.diagnosis.card import write_cards
        from calibration.diagnosis.report import write_report

        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "diagnosis.json").unlink(missing_ok=True)
        write_report(self.diagnosis, self.model, folder, title=self.experiment.name)
        write_cards(folder / "cards", self.diagnosis, self.experiment)
        text = json.dumps(self.diagnosis.to_json(), indent=1, ensure_ascii=False, allow_nan=False)
        write_whole(folder / "diagnosis.json", text + "\n")
        return folder / "report.html"

    def _rows(self) -> list[tuple[str, str, str, str]]:
        return [
            (cause["effect"], cause["scope"], name, f"{v['value']:.4g} ± {v['sd']:.2g}")
            for cause in self.causes
            for name, v in cause["parameters"].items()
        ]

    def __repr__(self) -> str:
        lines = [self.sentence, *("  " + ", ".join(row) for row in self._rows()), *self.diagnosis.implausible]
        if self.diagnosis.next_experiment:
            lines.append(f"Next: {self.diagnosis.next_experiment}.")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        table = _html_table(("effect", "scope", "parameter", "value"), self._rows()) if self.causes else ""
        following = self.diagnosis.next_experiment
        return (
            f"<p><strong>{escape(self.sentence)}</strong></p>"
            + table
            + "".join(f"<p>{escape(said)}</p>" for said in self.diagnosis.implausible)
            + (f"<p>Next: {escape(following)}.</p>" if following else "")
        )


@dataclass(frozen=True, eq=False, repr=False)
class PredictionResult:
    """Measured against predicted, for trials that no model was fitted to.

    Attributes
    ----------
    prediction : calibration.prediction.Prediction
        Records, each with its predictions and their standard deviations by source.
    """

    prediction: Prediction

    @property
    def sentence(self) -> str:
        """The result in one sentence."""
        return self.prediction.sentence()

    @property
    def skill(self) -> dict[str, float | None]:
        """Skill of the extension over the baseline, by kind of measurement; None where there is none."""
        return {k: self.prediction.skill(r) for k, r in self.prediction.of_kind().items()}

    @property
    def coverage(self) -> dict[str, dict[str, float]]:
        """Fraction of the points within their 95 % intervals, by kind of measurement and model."""
        p = self.prediction
        return {k: {m: p.coverage(r, m) for m in p.models} for k, r in p.of_kind().items()}

    def write(self, folder: str | Path) -> Path:
        """Write report.html, prediction.png and, last, prediction.json; the path of the page.

        A folder with a prediction.json is complete: that of an earlier prediction is removed first.
        """
        from calibration.prediction.page import write_page
        from calibration.prediction.schema import file_of

        folder = Path(folder)
        (folder / "prediction.json").unlink(missing_ok=True)
        page, *_ = write_page(self.prediction, folder)
        write_whole(folder / "prediction.json", file_of(self.prediction).model_dump_json(indent=1) + "\n")
        return page

    def rows(self) -> list[tuple[str, ...]]:
        """One row a record, in the order of `head`."""
        p = self.prediction
        rows = []
        for r in p.records:
            unit, per_si = r.shown.unit
            each = [f"{per_si * p.rms([r], m):.3g}" for m in p.models]
            inside = [f"{p.coverage([r], m):.0%}" for m in p.models]
            rows.append((r.name, r.kind, unit, f"{per_si * p.noise([r]):.3g}", *each, *inside))
        return rows

    def head(self) -> tuple[str, ...]:
        """Headings of `rows`."""
        models = self.prediction.models
        return (
            "record",
            "kind",
            "unit",
            "noise",
            *(f"rms, {m}" for m in models),
            *(f"within 95 %, {m}" for m in models),
        )

    def __repr__(self) -> str:
        return "\n".join([self.sentence, *("  " + ", ".join(row) for row in self.rows())])

    def _repr_html_(self) -> str:
        return f"<p><strong>{escape(self.sentence)}</strong></p>" + _html_table(self.head(), self.rows())


@dataclass(frozen=True, eq=False, repr=False)
class Reconstruction:
    """Outlines, mid lines and bodies that were traced from an experiment's photographs.

    Attributes
    ----------
    folder : Path
        Holds the traced experiment (`experiment.yaml`), outlines/, centrelines/, meshes/ and pictures/.
    experiment : Experiment
        The traced experiment, ready for `calibration.fit`.
    figures : dict
        Numbers of each capture, by its name (scale, tilt, uncertainty of the outline, ...).
    problems : dict
        Captures that could not be used, each with the reason.
    """

    folder: Path
    experiment: Experiment
    figures: dict[str, dict[str, Any]]
    problems: dict[str, str]

    HEAD = ("capture", "mm/px", "tilt / deg", "height / mm", "outline sd / mm", "shift sd / mm", "scale sd")

    def rows(self) -> list[tuple[str, ...]]:
        """One row a capture, in the order of HEAD."""
        found: list[tuple[str, ...]] = []
        for name, f in self.figures.items():
            own = ("-", "-", "-")
            if "mm_per_pixel" in f:
                own = (f"{f['mm_per_pixel']:.4f}", f"{f['tilt_deg']:.1f}", f"{f['diameter_mm']:.3f}")
            parts = [f[k] for k in ("registration_sd", "registration_shared_sd") if k in f]
            shift, scale = (hypot(*(part[k] for part in parts)) for k in ("shift_mm", "scale"))
            found.append((name, *own, f"{f['outline_sd_mm']:.4f}", f"{shift:.3f}", f"{scale:.4f}"))
        return found

    def __repr__(self) -> str:
        lines = [f"Reconstruction in {self.folder}: {len(self.figures)} captures"]
        lines += [f"  {name}: {figure['outline_sd_mm']:.4f} mm" for name, figure in self.figures.items()]
        return "\n".join([*lines, *(f"  {name}: not used: {why}" for name, why in self.problems.items())])

    def _repr_html_(self) -> str:
        left_out = "".join(f"<p>{escape(f'{n}: not used: {why}')}</p>" for n, why in self.problems.items())
        return f"<p>{escape(str(self.folder))}</p>" + _html_table(self.HEAD, self.rows()) + left_out


def _number(value: float, sd: float = float("nan")) -> str:
    if value != value:
        return "–"
    return f"{value:.4g}" + (f" ± {sd:.2g}" if sd == sd else "")


def _html_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    top = "".join(f"<th>{escape(h)}</th>" for h in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(str(c))}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
