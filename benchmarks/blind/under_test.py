"""The diagnosis under test: the only module of the laboratory that imports `calibration`.

It imports it when it is called, on an experiment's folder that holds no truth.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmarks.whole import write_whole

if TYPE_CHECKING:
    from calibration.diagnosis import Diagnosis, MeasurementModel

Verdict = dict[str, Any]  # the content of diagnosis.json, or the part of it that is scored

PROMISING = 12  # candidates that are fitted on noise-free data, besides those of the truth


class NotDiagnosedError(RuntimeError):
    """The command ended without a verdict."""


class NotFittedError(RuntimeError):
    """The command ended without a fit."""


@dataclass(frozen=True, kw_only=True)
class Diagnoser:
    """Diagnoses experiment folders of beams.

    Attributes
    ----------
    in_process : bool
        Call the diagnosis in this process instead of `command`.
    command : tuple of str
        The command line, without folder and options.
    workers : int or None
        Processes of a diagnosis; None takes all cores.
    """

    in_process: bool = False
    command: tuple[str, ...] = (sys.executable, "-m", "calibration.diagnose")
    workers: int | None = None

    def __call__(
        self,
        folder: Path,
        *,
        without: Iterable[str] = (),
        gain: bool = False,
        pose: Callable[[Any, Any], Any] | None = None,
    ) -> Verdict:
        """Content of diagnosis.json.

        Parameters
        ----------
        without : iterable of str
            Effects that are taken out of the catalogue.
        gain : bool
            Measure the held-out improvement too.
        pose : callable, optional
            The pose of the beams of repeated trials, as the diagnosis' own model takes it; the command line
            has no option for it, so that the diagnosis then runs in this process.

        Raises
        ------
        NotDiagnosedError
            The command wrote no diagnosis.json.
        """
        left_out = tuple(without)
        if self.in_process or pose is not None:
            return self._called(folder, left_out, gain, pose)
        with tempfile.TemporaryDirectory() as place:
            out = Path(place) / "found"
            command = [*self.command, str(folder), "--out", str(out)]
            command += ["--workers", str(self.workers)] if self.workers else []
            command += ["--without", ",".join(left_out)] if left_out else []
            command += [] if gain else ["--no-gain"]
            ended = subprocess.run(command, capture_output=True, text=True, check=False)
            path = out / "diagnosis.json"
            if not path.exists():
                problem = (ended.stderr or ended.stdout).strip()[-300:]
                raise NotDiagnosedError(f"exit code {ended.returncode}: {problem}")
            found: Verdict = json.loads(path.read_text(encoding="utf-8"))
            return found

    def _called(
        self, folder: Path, without: tuple[str, ...], gain: bool, pose: Callable[[Any, Any], Any] | None
    ) -> Verdict:
        from calibration.diagnosis import diagnose, model_of
        from calibration.diagnosis.catalogue import effects_of
        from calibration.experiment import read
        from calibration.measurements.outlines.model import OutlineModel

        data = read(folder)
        if pose is None:
            return diagnose(model_of(data, without=without, workers=self.workers), gain=gain).to_json()
        effects = {n: e for n, e in effects_of("outlines").items() if n not in without}
        model = OutlineModel(data, effects=effects, workers=self.workers, pose=pose)
        return diagnose(model, gain=gain).to_json()


class VerdictFile:
    """Verdicts by case in one JSON file: read where the file exists, written anew after each verdict."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.answers: dict[str, Verdict] = (
            json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        )

    def add(self, key: str, answer: Verdict) -> None:
        self.answers[key] = answer
        write_whole(self.path, json.dumps(self.answers))


def catalogue() -> tuple[str, ...]:
    """Names of the effects on beams that the diagnosis knows."""
    from calibration.diagnosis.catalogue import effects_of

    return tuple(effects_of("outlines"))


def pose_of(name: str, trials: set[str]) -> Callable[[Any, Any], Any]:
    """The diagnosis' own model of the advised pose `name`, applied to the repeated trials only."""
    from calibration.measurements.outlines.experiments import EXPERIMENTS, Photographs

    (design,) = [e for e in EXPERIMENTS if e.name == name]
    assert isinstance(design, Photographs)

    def posed(beam: Any, trial: Any) -> Any:
        return design.pose(beam, trial) if trial.id in trials else beam

    return posed


def diagnose_coupons(folder: Path, *, without: tuple[str, ...] = ()) -> Verdict:
    """As `_scored`; "next": the name of the advised experiment, None where the verdict is not ambiguous."""
    import calibration
    from calibration.diagnosis.engine.advice import advise

    data = calibration.read_experiment(folder)
    result = calibration.diagnose(data, domain="homogeneous", without=without, gain=False)
    model, finding = result.model, result.diagnosis.finding
    found = _scored(model, result.diagnosis)
    found["next"] = None
    if finding.verdict == "ambiguous":
        one_each = [next(e for e in finding.explanations if e.names == names) for names in finding.equivalent]
        found["next"] = advise(model, one_each)[0].name
    return found


def diagnose_indentation(folder: Path, *, without: tuple[str, ...] = ()) -> Verdict:
    """As `_scored`; with the number of simulated indentations, and their time on a core [s]."""
    import calibration
    from calibration.measurements.indentation.model import IndentationModel

    data = calibration.read_experiment(folder)
    result = calibration.diagnose(data, domain="indentation", without=without, gain=False, workers=1)
    model = result.model
    assert isinstance(model, IndentationModel)
    found = _scored(model, result.diagnosis)
    return found | {"simulated": model.curves.simulated, "core_seconds": model.curves.core_seconds}


def diagnose_compression(folder: Path, *, without: tuple[str, ...] = ()) -> Verdict:
    """The content of diagnosis.json, without the held-out improvement."""
    return _content(folder, "compression", without)


def diagnose_release(folder: Path, *, without: tuple[str, ...] = ()) -> Verdict:
    """The same, of bars that are let go."""
    return _content(folder, "release", without)


def _content(folder: Path, domain: str, without: tuple[str, ...]) -> Verdict:
    import calibration

    data = calibration.read_experiment(folder)
    return calibration.diagnose(
        data, domain=domain, without=without, gain=False, workers=1
    ).diagnosis.to_json()


def _scored(model: MeasurementModel, made: Diagnosis) -> Verdict:
    """The part of diagnosis.json that is scored; rms in the model's own unit."""
    from calibration.diagnosis.engine.held_out import held_out_improvement

    finding, content = made.finding, made.to_json()
    chosen = finding.chosen
    causes: list[dict[str, Any]] = []
    found: Verdict = {
        "verdict": finding.verdict,
        "causes": causes,
        "alternatives": [list(names) for names in finding.equivalent],
        "extended": None,
        "gain": None,
        "lack_of_fit": {
            "p": finding.lack_of_fit.p_value,
            "chance": finding.p_value,
            "worst": finding.lack_of_fit.worst,
        },
        "baseline": {"shear_modulus_Pa": model.shear_moduli(finding.baseline.state.u)},
        "share": content["share"],
        "nearest": content["nearest"],
        "tried": [(e.fit.label, e.fit.chi2, e.lack_of_fit.p_value) for e in finding.explanations],
    }
    if chosen is None:
        return found
    for c, said in zip(chosen.candidates, content["causes"], strict=True):
        effect = model.effects[c.effect]
        value, sd = chosen.fit.amplitude(c)
        causes.append(
            {
                "effect": c.effect,
                "label": c.label,
                "parameters": {effect.parameter: {"value": effect.in_file(value), "sd": effect.in_file(sd)}},
                "scope": c.at,
                "confidence": finding.confidence,
                "share": said["share"],
            }
        )
    found["extended"] = {"shear_modulus_Pa": model.shear_moduli(chosen.fit.state.u)}
    held_out = held_out_improvement(model, finding.baseline, chosen.fit)
    found["gain"] = {
        "held_out": held_out.held_out or "none",
        "rms_before": held_out.rms_before,
        "rms_after": held_out.rms_after,
        "rms_noise": held_out.rms_noise,
        "log_likelihood": held_out.log_likelihood,
    }
    return found


def noise_free_fits(kind: str, folder: Path, truth: str) -> dict[str, float]:
    """Least chi-square of each effect on data without noise, by name.

    Parameters
    ----------
    kind : str
        beams, coupons or indentation.
    truth : str
        The hidden effect; fitted even where it does not look promising.
    """
    from calibration.diagnosis.engine.explain import explain
    from calibration.diagnosis.engine.null import Null
    from calibration.diagnosis.engine.screening import screen
    from calibration.diagnosis.engine.search import fit_baseline
    from calibration.diagnosis.model import model_of
    from calibration.experiment import read

    model = model_of(read(folder), kind=kind, workers=1)
    baseline = fit_baseline(model)
    linear = model.linearise(baseline.state, model.candidates)
    screened = screen(linear, model.effects)
    null = Null(len(linear.z), model.discrepancy_basis(), seed=0)
    gains, amplitudes = screened.improvements(linear.z), screened.amplitudes(linear.z)
    least: dict[str, float] = {}
    for rank, k in enumerate(sorted(range(len(gains)), key=lambda k: -gains[k])):
        candidate = model.candidates[k]
        if rank >= PROMISING and candidate.effect != truth:
            continue
        found = explain(model, baseline, (candidate,), [float(amplitudes[k])], null)
        if found is not None:
            least[candidate.effect] = min(found.fit.chi2, least.get(candidate.effect, math.inf))
    return least


@dataclass(frozen=True, kw_only=True)
class Screening:
    """First-order improvement of beams' candidates on data without noise.

    Attributes
    ----------
    chi2 : float
        Of the baseline.
    best : tuple of (str, float)
        Label and standard deviations of the most promising candidate.
    sizes : list of (str, str, float)
        Effect, scope and standard deviations of each candidate.
    """

    chi2: float
    best: tuple[str, float]
    sizes: list[tuple[str, str, float]]


def screen_beams(folder: Path) -> Screening:
    """First-order amplitude of each candidate, as the diagnosis screens it."""
    import numpy as np

    from calibration.diagnosis.engine.screening import screen
    from calibration.diagnosis.engine.search import fit_baseline
    from calibration.diagnosis.model import model_of
    from calibration.experiment import read

    model = model_of(read(folder), kind="outlines", workers=1)
    baseline = fit_baseline(model)
    linear = model.linearise(baseline.state, model.candidates)
    screened = screen(linear, model.effects)
    sigmas = np.sqrt(screened.improvements(linear.z))
    best = int(np.argmax(screened.penalised(linear.z)))
    return Screening(
        chi2=float(baseline.chi2),
        best=(screened.candidates[best].label, float(sigmas[best])),
        sizes=[(c.effect, c.at, float(s)) for c, s in zip(screened.candidates, sigmas, strict=True)],
    )


def fit_command(
    folder: Path,
    out: Path,
    law: str,
    options: Iterable[str] = (),
    *,
    command: tuple[str, ...] = (sys.executable, "-m", "calibration.fit"),
) -> None:
    """Fit an experiment folder by the command line.

    Raises
    ------
    NotFittedError
        The command's own message, where its exit code is 2 or it ended in an error.
    """
    words = [*command, str(folder), "--model", law, *options, "--out", str(out)]
    ended = subprocess.run(words, capture_output=True, text=True, check=False)
    if ended.returncode not in (0, 1):  # 1: a fit with a status that is not "converged", which is written
        problem = (ended.stderr or ended.stdout).strip()[-400:]
        raise NotFittedError(f"exit code {ended.returncode}: {problem}")


def fit_in_process(folder: Path, out: Path, law: str, options: Iterable[str] = ()) -> None:
    """Run `fit_command` in this process, so that the next fit reuses its compiled kernels and solutions."""
    from calibration.fit import app

    said = io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said):
        words = [str(folder), "--model", law, *options, "--workers", "1", "--out", str(out)]
        code = app(words, standalone_mode=False)
    if code == 130:
        raise KeyboardInterrupt
    if code not in (0, 1):
        raise NotFittedError(f"exit code {code}: {said.getvalue().strip()[-400:]}")


def estimates_of(out: Path, material: str, law: str) -> dict[str, dict[str, float]]:
    """Estimates of a fit that the command wrote, by name: value and 95 % interval (low, high), SI.

    Raises
    ------
    NotFittedError
        There is no such fit.
    """
    path = out / "fits" / f"{material}-{law}.json"
    if not path.exists():
        raise NotFittedError(f"{path}: expected a fit")
    calibration = json.loads(path.read_text(encoding="utf-8"))["calibration"]
    return {
        e["name"]: {
            key: float("nan") if e[key] is None else float(e[key]) for key in ("value", "low", "high")
        }
        for e in calibration["estimates"]
    }
