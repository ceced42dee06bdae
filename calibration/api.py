"""The Python interface: `calibration.read_experiment`, `reconstruct`, `fit`, `diagnose` and `predict`.

>>> import calibration
>>> experiment = calibration.read_experiment(folder)
>>> fits = calibration.fit(experiment, model="neo-hookean", workers=1)
>>> fits.materials
('rubber',)
>>> f"{fits.best('rubber').shear_modulus / 1e3:.1f} kPa"
'30.0 kPa'
>>> fits
Fits of 'made strip': 1
  rubber: shear modulus 30.0... kPa by neo-hookean; no other law was tried.
  Calibration(rubber, neo-hookean: converged, G 30... kPa)

(`folder` holds a strip that was pulled to twice its length, made by
`tests/calibration/interface/test_interface.py`, which runs this example.)

Messages go to the log "calibration"; give `on_progress` to have them as objects.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from calibration.errors import InputError, OptionError
from calibration.experiment import Experiment, read
from calibration.fit_plan import names_of, plan_fit, processes
from calibration.fit_request import FitRequest
from calibration.progress import OnProgress, Progress, to_log
from calibration.results import DiagnosisResult, Fits, PredictionResult, Reconstruction


def read_experiment(folder: str | Path, *, leave_out_rows: bool = False) -> Experiment:
    """Read and check an experiment.

    Parameters
    ----------
    folder : path
        Holds experiment.yaml (format 1) and the files that it names.
    leave_out_rows : bool
        Go on without rows of homogeneous tests at which the clock runs backwards; `Experiment.notes` says
        which. An error otherwise.

    Returns
    -------
    Experiment
        In SI units.

    Raises
    ------
    InputError
        One sentence that names the file, the key or line, and what was expected.
    """
    return read(Path(folder), leave_out_rows=leave_out_rows)


def fit(
    experiment: str | Path | Experiment,
    *,
    model: str | Sequence[str] = FitRequest.model,
    materials: str | Sequence[str] | None = None,
    terms: int = FitRequest.terms,
    time: str | None = None,
    damage: str | None = None,
    fibres: bool = FitRequest.fibres,
    objective: str = FitRequest.objective,
    free_bulk_ratio: bool = FitRequest.free_bulk_ratio,
    rig: str | Path | None = None,
    start: str | Path | None = None,
    out: str | Path | None = None,
    seed: int = FitRequest.seed,
    population: int | None = None,
    generations: int = FitRequest.generations,
    restarts: int = FitRequest.restarts,
    polish: bool = FitRequest.polish,
    held_out: bool = FitRequest.held_out,
    workers: int | None = None,
    overwrite: bool = FitRequest.overwrite,
    on_progress: OnProgress | None = None,
) -> Fits:
    """Fit constitutive laws to all measurements of each material.

    Parameters
    ----------
    experiment : path or Experiment
    model : str or sequence of str
        Laws; "all" for every law that is registered in `tisim.laws`.
    materials : str or sequence of str, optional
        All of the experiment where left out.
    terms : int
        Terms of a series law (Ogden).
    time : str, optional
        Relaxation beside each law, from tests with a column time_s: "prony:1" to "prony:3" for so
        many terms with free times, "prony" where the data choose their number, "prony:spectrum" for two
        stated times a decade.
    damage : str, optional
        Softening beside each law: "mullins" (Ogden and Roxburgh).
    fibres : bool
        One family of fibres beside each law (Holzapfel, Gasser and Ogden), at the same angle in all
        homogeneous tests.
    objective : str
        "likelihood", or "dice" for the overlap of bodies as in the paper (no error bars).
    free_bulk_ratio : bool
        Find K/G too, where there are photographs of beams. Else it is held at 300, as a diagnosis holds it,
        and the other constants' intervals have their part of its uncertainty.
    rig : path, optional
        rig.yaml of a diagnosis of photographed beams: faults of rig and camera to correct for.
    start : path, optional
        A material card, or a folder of cards by material: viscosity, softening and fibres that the fit holds
        as they are, or begins its search at where `time`, `damage` or `fibres` asks for them.
    out : path, optional
        Folder that keeps the fits, so that the same call goes on after an interruption; in memory where
        left out. `Fits.write_report` and `Fits.write_cards` write what people and the factory read.
    seed, population, generations, restarts : int
        Options of CMA-ES.
    polish : bool
        Gauss-Newton polish and error bars.
    held_out : bool
        Predict each beam from the others.
    workers : int, optional
        Processes; all cores that this process may use where left out.
    overwrite : bool
        Discard earlier results and start again.
    on_progress : callable, optional
        Called with a `calibration.progress.FitProgress`, about twice a second.

    Returns
    -------
    Fits

    Raises
    ------
    InputError
        An argument, the experiment or the folder cannot be used.
    """
    with tempfile.TemporaryDirectory(prefix="calibration-") as memory:
        request = FitRequest(
            model=model,
            materials=materials,
            terms=terms,
            time=time,
            damage=damage,
            fibres=fibres,
            objective=objective,
            free_bulk_ratio=free_bulk_ratio,
            rig=rig,
            start=start,
            out=out if out is not None else memory,
            seed=seed,
            population=population,
            generations=generations,
            restarts=restarts,
            polish=polish,
            held_out=held_out,
            workers=workers,
            overwrite=overwrite,
        )
        found = plan_fit(experiment, request).run(on_progress or to_log)
    return found if out is not None else Fits(found.results, found.experiment)


def diagnose(
    experiment: str | Path | Experiment,
    *,
    domain: str | None = None,
    without: str | Sequence[str] = (),
    simulator: str = "tisim",
    law: str = "auto",
    gain: bool = True,
    noise: str = "stated",
    seed: int = 0,
    workers: int | None = None,
    on_progress: OnProgress | None = None,
) -> DiagnosisResult:
    """Find what the simulation of an experiment lacks.

    Parameters
    ----------
    experiment : path or Experiment
    domain : str, optional
        Kind of measurements, where the experiment has several (`calibration.diagnosis.kinds()`).
    without : str or sequence of str
        Effects to leave out of the catalogue.
    simulator : str
        Simulator whose own faults are looked for as well.
    law : str
        Law of the baseline, where the kind has a choice: "auto" for the simplest one and, where no cause
        explains the data beside it, the one that predicts best as a cause of its own; or a name, with the
        terms of a series law ("ogden:2").
    gain : bool
        Measure the improvement on held-out data.
    noise : str
        "stated", or "data" where the scatter of the data shall replace a stated noise that it contradicts.
    seed : int
        Seed of the bootstrap.
    workers : int, optional
        Processes; all cores where left out.
    on_progress : callable, optional
        Called with a `calibration.progress.Progress`.

    Returns
    -------
    DiagnosisResult

    Raises
    ------
    InputError
        An argument or the experiment cannot be used, or the baseline has no equilibrium anywhere.
    """
    from calibration.diagnosis import Rules, model_of
    from calibration.diagnosis.card import check_names
    from calibration.diagnosis.laws import diagnose_with_law

    if seed < 0:
        raise OptionError("seed", seed, "expected 0 or more")
    if noise not in ("stated", "data"):
        raise OptionError("noise", noise, "expected stated or data")
    processes(workers)
    data = experiment if isinstance(experiment, Experiment) else read(Path(experiment))
    check_names({t.material for t in data.trials})
    report = on_progress or to_log
    make = partial(
        model_of, data, kind=domain, without=names_of(without), simulator=simulator, workers=workers
    )
    try:
        found, model = diagnose_with_law(
            make,
            law=law,
            rules=Rules(seed=seed),
            gain=gain,
            noise="data" if noise == "data" else "stated",
            on_progress=lambda text: report(Progress(message=text)),
        )
    except ValueError as error:  # no equilibrium of the baseline anywhere
        raise InputError(f"{data.folder}: the baseline cannot be calibrated: {error}") from error
    return DiagnosisResult(found, data, model)


def predict(
    experiment: str | Path | Experiment,
    cards: str | Path | None = None,
    *,
    calibrate: str | None = None,
    predict: str | None = None,
    baseline: str | Path | None = None,
    domain: str | None = None,
    law: str = "auto",
    extend: str | Sequence[str] = (),
    specimen_scatter: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    on_progress: OnProgress | None = None,
) -> PredictionResult:
    """Measured against predicted, for trials that no model was fitted to.

    Parameters
    ----------
    experiment : path or Experiment
    cards : path, optional
        Folder of material cards (or one), by which all trials are predicted; in place of `calibrate`.
    calibrate, predict : str, optional
        Trials to fit, and trials to predict: ids with * and ?, or material=, specimen=, length= (of a beam in
        mm) or mode= (of a coupon) with a value, several by commas. Beside `cards`, `predict` alone: the
        trials that the cards predict.
    baseline : path, optional
        Cards that stand beside `cards` in place of the baseline that they state.
    domain : str, optional
        Kind of measurements: of the fit, where the experiment has several; the only one that cards predict.
    law : str
        Law of the baseline beside which a fit looks for causes, as in `diagnose`.
    extend : str or sequence of str
        Effects of the extension beside `calibrate`, each in all trials, in place of a search for causes.
    specimen_scatter : float, optional
        Relative sd of the modulus from one specimen of a material to the next, where cards predict a named
        specimen: 0.15 where left out.
    seed : int
        Seed of the diagnosis.
    workers : int, optional
        Processes; all cores where left out.
    on_progress : callable, optional
        Called with a `calibration.progress.Progress`.

    Returns
    -------
    PredictionResult

    Raises
    ------
    InputError
        An argument, a card or the experiment cannot be used.
    """
    from calibration.prediction import from_cards, from_trials
    from calibration.prediction._select import chosen, split

    if (cards is None) == (calibrate is None):
        raise OptionError("calibrate", calibrate, "expected either cards, or the trials to fit")
    if calibrate is not None and predict is None:
        raise OptionError("predict", None, "expected the trials to predict, beside --calibrate")
    if cards is not None and extend:
        raise OptionError(
            "extend", ", ".join(names_of(extend)), "expected without cards, which state their effects"
        )
    if cards is not None and law != "auto":
        raise OptionError("law", law, "expected without cards, which state their laws")
    if calibrate is not None and baseline is not None:
        raise OptionError("baseline", baseline, "expected with cards only, a fit has its own")
    if calibrate is not None and specimen_scatter is not None:
        raise OptionError("specimen_scatter", specimen_scatter, "expected with cards only")
    if specimen_scatter is not None and not 0.0 <= specimen_scatter < 2.0:
        raise OptionError("specimen_scatter", specimen_scatter, "expected a number from 0 to 2")
    if seed < 0:
        raise OptionError("seed", seed, "expected 0 or more")
    processes(workers)
    data = experiment if isinstance(experiment, Experiment) else read(Path(experiment))
    report = on_progress or to_log

    def message(text: str) -> None:
        report(Progress(message=text))

    if calibrate is not None and predict is not None:
        fitted, wanted = split(data, calibrate, predict)
        found = from_trials(
            data,
            fitted,
            wanted,
            domain=domain,
            law=law,
            extend=tuple(names_of(extend)),
            seed=seed,
            workers=workers,
            on_progress=message,
        )
        return PredictionResult(found)
    assert cards is not None
    some = data if predict is None else replace(data, trials=chosen(data, predict, "predict"))
    return PredictionResult(
        from_cards(
            Path(cards),
            some,
            baseline=None if baseline is None else Path(baseline),
            domain=domain,
            specimen_scatter=specimen_scatter,
            workers=workers,
            on_progress=message,
        )
    )


def reconstruct(
    experiment: str | Path,
    *,
    out: str | Path | None = None,
    resume: bool = True,
    skip_bad: bool = False,
    on_progress: OnProgress | None = None,
) -> Reconstruction:
    """Trace the photographs of an experiment: outline, mid line and swept body of each.

    Parameters
    ----------
    experiment : path
        Folder with experiment.yaml and photographs.
    out : path, optional
        Folder to write; the experiment's name with -traced, in the current folder, where left out.
    resume : bool
        Keep what is already traced.
    skip_bad : bool
        Leave out photographs that cannot be used, in place of an error.
    on_progress : callable, optional
        Called with a `calibration.progress.Progress` after each photograph.

    Returns
    -------
    Reconstruction

    Raises
    ------
    InputError
        A photograph cannot be used; what could be traced is kept.
    """
    from calibration.photo.reconstruction import reconstruct as trace

    return trace(
        Path(experiment),
        out=None if out is None else Path(out),
        resume=resume,
        skip_bad=skip_bad,
        on_progress=on_progress or to_log,
    )
