"""The catalogue of effects as a page of the reference, read off the code and off a shipped experiment a kind.

    python -m studies.effects              (some minutes; writes docs/reference/effects.md and its pictures)

What an effect does is its simulation less that of the baseline, moduli and nuisances fitted again to first
order: what is left for a diagnosis to see. Two effects hide one another where these differences are alike,
the noise counted.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray

from calibration import read_experiment
from calibration.diagnosis.catalogue import effects_of
from calibration.diagnosis.engine.screening import screen
from calibration.diagnosis.engine.search import fit_baseline
from calibration.measurements._effect import Candidate, EffectModel
from calibration.measurements._kinds import build, kind_of
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State

mpl.use("Agg")
import matplotlib.pyplot as plt

Array = NDArray[np.float64]
ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "reference" / "effects.md"
PICTURES = ROOT / "docs" / "pictures"
MEASURED = ROOT / "datasets" / "measured"
# An experiment a kind, and what it is, for people.
EXAMPLES = {
    "outlines": (MEASURED / "bench" / "clean", "photographed beams"),
    "homogeneous": (MEASURED / "coupons", "homogeneous tests"),
    "compression": (MEASURED / "compression", "compression between platens"),
    "indentation": (MEASURED / "indentation", "indentation"),
}
SEEN = 5.0  # standard deviations from which on a design sees an effect
ALIKE = 0.9  # cosine of two effects from which on each hides the other
COLUMNS = 4
INTRODUCTION = f"""# Catalogue of effects

*Made by `python -m studies.effects`; not to be edited.*

Every cause that a diagnosis can name, by kind of measurement. The unit ends the parameter's name; a
positive amplitude is what the sentence says. **Seen from**: the amplitude at which the shipped experiment
of that kind shows the effect at {SEEN:g} standard deviations, moduli and nuisances fitted beside it.
**Hidden by**: effects that change the same records alike (cosine above {ALIKE:g}, in brackets), so that
this design cannot tell them apart; a diagnosis then says *ambiguous* and names both. **Settled by**: what
to do on the bench. Pictures: what is left of the effect after the baseline's fit, in the record that shows
it best. *Further* causes are asked in a second round. One's own effect: [extend](../how-to/extend.md).
"""


@dataclass(frozen=True, kw_only=True)
class Seen:
    """An effect in an experiment.

    Attributes
    ----------
    limit, amplitude : that would be seen (infinite where none is), and that is drawn [the file's unit].
    x, change : what it does to the record that shows it best.
    """

    effect: EffectModel
    limit: float
    amplitude: float
    hidden_by: tuple[tuple[str, float], ...]
    record: str
    x: Array
    change: Array
    axis: str
    unit: str


def seen_in(model: MeasurementModel, effects: Mapping[str, EffectModel]) -> Iterator[Seen]:
    """Each effect of a kind in an experiment, in all records that it applies to."""
    baseline = fit_baseline(model)
    linear = model.linearise(baseline.state, model.candidates)
    projected = screen(linear, effects)
    best: dict[str, int] = {}
    for k, candidate in enumerate(projected.candidates):
        old = best.get(candidate.effect)
        widest = candidate.at == "all" or old is None
        if old is None or (widest and projected.sizes[k] > projected.sizes[old]):
            best[candidate.effect] = k
    at_rest = model.registered(baseline.state)
    for name, k in best.items():
        effect, candidate = effects[name], projected.candidates[k]
        size = float(projected.sizes[k])
        limit = SEEN / size if size > 0 else np.inf
        wanted = min(limit, effect.prior_scale) if np.isfinite(limit) else effect.prior_scale
        amplitude = float(np.clip(wanted, *(0.9 * np.array(effect.bounds)))) or 0.5 * effect.bounds[0]
        others = sorted(
            (
                (other, abs(float(projected.directions[:, k] @ projected.directions[:, j])))
                for other, j in best.items()
                if other != name
            ),
            key=lambda pair: -pair[1],
        )
        refit = np.linalg.lstsq(linear.by_u, -amplitude * linear.columns[:, k], rcond=None)[0]
        changes = _changes(model, baseline.state, at_rest, refit.astype(np.float64), candidate, amplitude)
        shown = [model.shown(i) for i in range(len(model.records))]
        drawn = [np.nan_to_num(c) for c in changes]
        drawn = [c if len(c) == len(s.x) else s.points(c) for s, c in zip(shown, drawn, strict=True)]
        i = int(np.argmax([np.sqrt(np.mean(d**2)) for d in drawn]))
        yield Seen(
            effect=effect,
            limit=abs(effect.effect.in_file(limit)),
            amplitude=effect.effect.in_file(amplitude),
            hidden_by=tuple((o, c) for o, c in others if c > ALIKE)[:4],
            record=str(model.records[i].name),
            x=shown[i].x,
            change=drawn[i] * shown[i].unit[1],
            axis=shown[i].axis,
            unit=f"change [{shown[i].unit[0]}]",
        )


def _changes(
    model: MeasurementModel,
    state: State,
    at_rest: list[Array],
    refit: Array,
    candidate: Candidate,
    amplitude: float,
) -> list[Array]:
    """Change of each record by an effect [SI]. refit : change of the baseline's coordinates that fits it."""
    part = 1.0
    for _ in range(6):
        try:
            found = model.registered(
                State(u=state.u + part * refit, amplitudes={candidate: part * amplitude})
            )
        except ValueError:  # no answer so far away: less of it
            part *= 0.5
        else:
            return [new - old for new, old in zip(found, at_rest, strict=True)]
    raise ValueError(f"{candidate.label}: the model has no answer at {part * amplitude}")


def draw(found: list[Seen], path: Path) -> None:
    rows = -(-len(found) // COLUMNS)
    figure, axes = plt.subplots(rows, COLUMNS, figsize=(11, 1.9 * rows), layout="constrained", squeeze=False)
    for axis, seen in zip(axes.flat, found, strict=False):
        axis.plot(seen.x, seen.change, ".", markersize=2.5, color="#1f5fa8")
        axis.axhline(0.0, color="0.75", linewidth=0.8, zorder=0)
        axis.set_title(seen.effect.name, fontsize=9)
        axis.set_xlabel(f"{seen.axis} ({seen.record})", fontsize=6.5)
        axis.set_ylabel(seen.unit, fontsize=6.5)
        axis.tick_params(labelsize=6.5)
    for axis in axes.flat[len(found) :]:
        axis.set_axis_off()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def page(kinds: Mapping[str, list[Seen]]) -> str:
    lines = [INTRODUCTION]
    for kind, found in kinds.items():
        folder, words = EXAMPLES[kind]
        lines += [
            f"## {words[0].upper()}{words[1:]}",
            "",
            f"`--kind {kind}`; experiment `{folder.relative_to(ROOT)}`.",
            "",
        ]
        lines += [f"![What each effect changes]({Path('..') / 'pictures' / f'effects-{kind}.png'})", ""]
        lines += ["| effect | what | belongs to | parameter | seen from | hidden by | settled by |"]
        lines += ["| --- | --- | --- | --- | --- | --- | --- |"]
        for seen in found:
            e = seen.effect.effect
            hidden = ", ".join(f"{name} ({cosine:.2f})" for name, cosine in seen.hidden_by) or "none"
            limit = "not in this design" if not np.isfinite(seen.limit) else f"{seen.limit:.2g}"
            further = " (further)" if seen.effect.further else ""
            lines.append(
                f"| {e.name}{further} | {e.sentence} | {e.belongs_to} | `{e.parameter}` | {limit} | {hidden} "
                f"| {seen.effect.action or e.remedy} |"
            )
        missing = [n for n in effects_of(kind) if n not in {s.effect.name for s in found}]
        if missing:
            lines += ["", f"No record of this experiment can have: {', '.join(missing)}."]
        lines.append("")
    lines += [
        "## Released beams",
        "",
        "`--kind release`; markers through time. No experiment of this kind is shipped.",
        "",
    ]
    lines += ["| effect | what | belongs to | parameter | settled by |", "| --- | --- | --- | --- | --- |"]
    for name, model in effects_of("release").items():
        e = model.effect
        further = " (further)" if model.further else ""
        settled = model.action or e.remedy
        lines.append(f"| {name}{further} | {e.sentence} | {e.belongs_to} | `{e.parameter}` | {settled} |")
    lines.append("")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kinds", nargs="*", default=list(EXAMPLES), choices=list(EXAMPLES))
    kinds: dict[str, list[Seen]] = {}
    for name in parser.parse_args().kinds:
        effects = effects_of(name)
        experiment = read_experiment(EXAMPLES[name][0])
        model = build(kind_of(experiment, name), experiment, effects=effects, workers=1)
        kinds[name] = list(seen_in(model, effects))
        draw([seen for seen in kinds[name] if np.isfinite(seen.limit)], PICTURES / f"effects-{name}.png")
        print(f"{name}: {len(kinds[name])} effects", flush=True)
    PAGE.write_text(page(kinds), encoding="utf-8")


if __name__ == "__main__":
    main()
