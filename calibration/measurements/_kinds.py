"""Registry of the kinds of measurement, and selection of the kind and the model for an experiment.

A new kind is one file with a `MeasurementModel`, and one registration::

    register(Kind(name="torsion", holds=lambda experiment: ..., load=lambda: TorsionModel))

A kind that a fit and predictions compare has `compares`, and one that supports fits of time-dependent parts
has `over_time`, which is also imported when needed::

    register(Kind(..., compares=lambda experiment: ..., over_time=lambda: OVER_TIME))

The order of registration is that of objectives in a fit and of kinds in a prediction.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import Any

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, CouponTrial, Experiment, PokeTrial, Trial
from calibration.measurements._baseline import Baseline
from calibration.measurements._contribution import Contribute, Contribution, FitContext, ObjectiveName
from calibration.measurements._effect import EffectModel
from calibration.measurements._model import MeasurementModel
from calibration.measurements._over_time import OverTime
from calibration.measurements.objective import ModelObjective


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of measurement.

    Attributes
    ----------
    name : name on the command line and in reports.
    holds : function that is True for an experiment with trials of this kind.
    load : function that imports and returns the model class, which is called with an experiment, `effects`,
        those options of `build` that `takes` names and, if the kind has `compares`, `baseline`.
    refines : name of a kind to which the same trials belong; if no kind is named, this one is selected if
        `claims` is True for the experiment, else the other.
    takes : options of its model: workers, simulator, setup; law, terms and richer (of the baseline).
    old_name : name in earlier versions, still accepted.
    compares : function from an experiment of one material to the trials that a fit compares with this kind's
        model; empty for a kind that is only diagnosed.
    objectives : functions that import what it brings to a fit, by the objective's name; if there is no
        likelihood among them, it is that of its model.
    whole : function that is True for an experiment all of whose trials `load`'s model takes; others are
        fitted by further models (`models`).
    plural : its trials in the name of that likelihood ("pokes"); its own name if left out.
    over_time : function that imports its support of viscosity, softening and fibres; None if it has none.
    """

    name: str
    holds: Callable[[Experiment], bool]
    load: Callable[[], Callable[..., MeasurementModel]]
    refines: str = ""
    claims: Callable[[Experiment], bool] = lambda _: False
    takes: tuple[str, ...] = ()
    old_name: str = ""
    compares: Callable[[Experiment], Sequence[Trial]] = lambda _: ()
    objectives: Mapping[ObjectiveName, Callable[[], Contribute]] = field(default_factory=dict)
    whole: Callable[[Experiment], bool] = lambda _: True
    plural: str = ""
    over_time: Callable[[], OverTime] | None = None


_KINDS: dict[str, Kind] = {}


def register(kind: Kind) -> None:
    """Register a kind; ValueError if its name is taken."""
    if kind.name in _KINDS:
        raise ValueError(f"kind of measurement {kind.name}: it is registered already")
    _KINDS[kind.name] = kind


def unregister(name: str) -> None:
    """Remove a kind from the registry."""
    del _KINDS[name]


def is_added(kind: Kind) -> bool:
    """True for a kind from outside the package, which other processes may not know."""
    return kind.name not in _OURS


def true_kind(name: str) -> str:
    """Current name of a kind, from its current or an earlier name. ValueError for a kind that is unknown."""
    for kind in _KINDS.values():
        if name in (kind.name, kind.old_name or kind.name):
            return kind.name
    raise ValueError(f"kind of measurement {name}: expected one of {', '.join(_KINDS)}")


def kinds() -> tuple[str, ...]:
    """Names of all registered kinds."""
    return tuple(_KINDS)


def kind_of(experiment: Experiment, name: str | None = None) -> Kind:
    """The kind of this name; without a name, the kind of the experiment's trials.

    Raises
    ------
    InputError
        If the name is unknown, the experiment has no trials of the kind, or it has several kinds and none is
        named.
    """
    there = [n for n, k in _KINDS.items() if k.holds(experiment)]
    if name is not None:
        try:
            named = _KINDS[true_kind(name)]
        except ValueError:
            raise InputError(f"--kind {name}: expected one of {', '.join(_KINDS)}") from None
        if named.name not in there:
            has = ", ".join(there) or "no trials"
            raise InputError(f"--kind {name}: the experiment has none; it has {has}")
        return named
    if not there:
        raise InputError(f"experiment.yaml: trials: expected some of {', '.join(_KINDS)}")
    for kind in [_KINDS[n] for n in there]:
        if kind.refines in there:
            there.remove(kind.refines if kind.claims(experiment) else kind.name)
    if len(there) > 1:
        raise InputError(f"the experiment has {' and '.join(there)}: say which with --kind")
    return _KINDS[there[0]]


def compared(experiment: Experiment) -> list[tuple[Kind, Experiment]]:
    """Kinds that a fit of an experiment of one material compares, each with an experiment of its trials."""
    found = []
    for kind in _KINDS.values():
        trials = tuple(kind.compares(experiment))
        if trials:
            found.append((kind, replace(experiment, trials=trials)))
    return found


def build(
    kind: Kind,
    experiment: Experiment,
    *,
    effects: Mapping[str, EffectModel] | None = None,
    baseline: Baseline | None = None,
    **options: Any,
) -> MeasurementModel:
    """Build the model of an experiment's measurements of a kind.

    baseline : baseline of a law that is fitted or predicted from; None for the kind's own.
    options : see `Kind.takes`; options that the kind does not take are ignored.
    """
    own = {n: v for n, v in options.items() if n in kind.takes}
    if baseline is not None:
        own["baseline"] = baseline
    return kind.load()(experiment, effects=effects or {}, **own)


def contribution(
    kind: Kind, own: Experiment, context: FitContext, objective: ObjectiveName = "likelihood"
) -> Contribution | None:
    """Objective of a kind, for a fit of its trials of one material; None if it has no such objective."""
    if objective in kind.objectives:
        return kind.objectives[objective]()(own, context)
    if objective != "likelihood":
        return None
    model = build(
        kind,
        own,
        baseline=Baseline.of_law(own.trials, context.law),
        workers=context.workers,
        simulator=context.simulator,
        setup=context.setup,
    )
    name = f"{kind.plural or kind.name} {', '.join(t.id for t in own.trials)}"
    return Contribution(objectives=(ModelObjective(model, name=name),), left_out=tuple(model.left_out()))


def models(
    kind: Kind, own: Experiment, context: FitContext
) -> tuple[Sequence[MeasurementModel], Sequence[str]]:
    """Models by which a fit compares an experiment of a kind's trials of one material, and what they leave
    out: a prediction compares the same. The kind's own model, where its objectives have none.
    """
    found = contribution(kind, own, context)
    assert found is not None, "every kind has a likelihood"
    mine = [o.model for o in found.objectives if isinstance(o, ModelObjective)]
    if not mine:
        baseline = Baseline.of_law(own.trials, context.law)
        mine = [build(kind, own, baseline=baseline, workers=context.workers)]
    return mine, found.left_out


def _late(module: str, name: str) -> Callable[[], Any]:
    """Function that imports a name of a module of `calibration.measurements` when it is called."""
    return lambda: getattr(import_module(f"calibration.measurements.{module}"), name)


def _outlined(experiment: Experiment) -> list[Trial]:
    return [t for t in experiment.trials if isinstance(t, BeamTrial) and t.traced]


def _marked(experiment: Experiment) -> list[Trial]:
    return [t for t in experiment.trials if isinstance(t, BeamTrial) and t.markers]


def _all_recorded(experiment: Experiment) -> bool:
    from calibration.measurements.release._record import why_no_record

    beams = [t for t in experiment.trials if isinstance(t, BeamTrial) and t.markers]
    return not any(why_no_record(t, experiment) for t in beams)


def _pushed(experiment: Experiment) -> list[Trial]:
    return [t for t in experiment.trials if isinstance(t, PokeTrial) and t.inclusion_mesh is None]


def _coupons(experiment: Experiment) -> list[Trial]:
    return [t for t in experiment.trials if isinstance(t, CouponTrial)]


def _compressed(experiment: Experiment) -> list[bool]:
    from calibration.measurements.compression._record import between_platens

    return [between_platens(t.mode, t.stretch) for t in experiment.trials if isinstance(t, CouponTrial)]


def _all_compressed(experiment: Experiment) -> bool:
    return all(_compressed(experiment))


register(
    Kind(
        name="outlines",
        holds=lambda e: any(isinstance(t, BeamTrial) for t in e.trials),
        load=_late("outlines.model", "OutlineModel"),
        takes=("workers", "simulator", "setup"),
        old_name="beams",
        compares=_outlined,
        objectives={"dice": _late("outlines.dice", "overlap")},
        over_time=_late("outlines.over_time", "OVER_TIME"),
    )
)
register(
    Kind(
        name="homogeneous",
        holds=lambda e: any(isinstance(t, CouponTrial) for t in e.trials),
        load=_late("homogeneous.model", "HomogeneousModel"),
        takes=("law", "terms", "richer"),
        old_name="coupons",
        compares=lambda e: [] if _all_compressed(e) else _coupons(e),
        plural="coupons",
        over_time=_late("homogeneous.over_time", "OVER_TIME"),
    )
)
register(
    Kind(
        name="compression",
        holds=lambda e: any(_compressed(e)),
        load=_late("compression.model", "CompressionModel"),
        refines="homogeneous",
        claims=_all_compressed,
        old_name="presses",
        compares=lambda e: _coupons(e) if _all_compressed(e) else [],
        plural="coupons",
        over_time=_late("compression.over_time", "OVER_TIME"),
    )
)
register(
    Kind(
        name="indentation",
        holds=lambda e: any(isinstance(t, PokeTrial) for t in e.trials),
        load=_late("indentation.model", "IndentationModel"),
        takes=("workers",),
        old_name="pokes",
        compares=_pushed,
        plural="pokes",
        over_time=_late("indentation.over_time", "OVER_TIME"),
    )
)
register(
    Kind(
        name="release",
        holds=lambda e: bool(_marked(e)),
        load=_late("release.model", "ReleaseModel"),
        refines="outlines",
        claims=lambda e: not _outlined(e),
        takes=("workers",),
        old_name="bars",
        compares=_marked,
        objectives={"likelihood": _late("release.contribution", "likelihood")},
        whole=_all_recorded,
        over_time=_late("release.over_time", "OVER_TIME"),
    )
)

_OURS = frozenset(_KINDS)
