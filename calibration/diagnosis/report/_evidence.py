"""Evidence for each cause: its improvement of chi-square against noise, and its distance from the best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from calibration.diagnosis.drawing import label_of_causes
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.search import Finding, Rules
from calibration.diagnosis.report._words import headline
from calibration.pages import BAND, COLOURS, FAINT, INK, Picture, paper, picture, plain, significant

CONFIRMED, SCREENED, NAMED = COLOURS[0], "#C3CBD3", COLOURS[1]
FREQUENT, RARE = 0.05, Rules().false_alarm_rate  # rates of false alarms, drawn as lines
ALTERNATIVE = 6.0  # difference of chi-square from the best, up to which a cause is an alternative to it
_MOST = 40  # bars


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A cause, or a set of causes, at the position and scope where it explains most.

    Attributes
    ----------
    name : label of the cause.
    gain : improvement of chi-square over the baseline minus the multiplicity penalty, at least 0.
    behind : difference of its score from the best; None if it was only screened.
    named : True if the verdict names it.
    converged : True if its fit converged.
    """

    name: str
    gain: float
    behind: float | None
    named: bool
    converged: bool = True


def bars(finding: Finding) -> list[Bar]:
    """One bar per effect and one per confirmed set of effects, the largest improvement first.

    Improvements of confirmed explanations are from the simulator, all others to first order.
    """
    found: dict[tuple[str, ...], Bar] = {}
    best = finding.explanations[0].score if finding.explanations else 0.0
    for e in sorted(finding.explanations, key=lambda e: e.score):
        if e.names not in found:
            found[e.names] = _confirmed(e, finding, best)
    gains = finding.screened.penalised(finding.baseline.z)
    for k in np.argsort(-gains):
        c = finding.screened.candidates[k]
        if (c.effect,) not in found:
            found[(c.effect,)] = Bar(name=c.label, gain=max(0.0, float(gains[k])), behind=None, named=False)
    return sorted(found.values(), key=lambda b: -b.gain)


def _confirmed(e: Explanation, finding: Finding, best: float) -> Bar:
    return Bar(
        name=e.fit.label,
        gain=max(0.0, finding.baseline.chi2 - e.fit.chi2 - e.multiplicity_penalty),
        behind=e.score - best,
        named=e.names in finding.equivalent,
        converged=e.fit.converged,
    )


def draw_evidence(finding: Finding) -> Picture:
    """Bars of the improvements (left) and, if causes are named, distances from the best one (right)."""
    everything = bars(finding)
    shown = everything[:_MOST]
    confirmed = [b for b in shown if b.behind is not None]
    figure = paper(11.0, 1.5 + 0.27 * len(shown))
    if finding.equivalent and confirmed:
        left, right = figure.subplots(1, 2, sharey=True, width_ratios=(3, 2))
        _behind(right, shown)
    else:
        left = figure.subplots(1, 1)
    _gains(left, shown, finding)
    figure.legend(loc="outside upper left", ncols=3, fontsize=8, frameon=False)
    left_out = len(everything) - len(shown)
    caption = (
        f"{headline(finding)}. Part of the misfit that each cause explains, in standard deviations: root"
        " of the"
        " improvement of chi-square minus twice the logarithm of the number of candidate positions, which is"
        " written at the ends of the bars. Each effect is at its best position. Grey bars were screened"
        " to first"
        " order, coloured ones fitted in the simulator. Noise alone gives the best of all causes the"
        " range left"
        " of the lines."
        + (" Right: misfit that the best cause explains and this one does not." if finding.equivalent else "")
        + (f" {left_out} weaker ones are not drawn." if left_out else "")
    )
    return picture(figure, "evidence", caption)


def _gains(axes: Any, shown: Sequence[Bar], finding: Finding) -> None:
    plain(axes)
    rows = np.arange(len(shown))
    drawn = np.sqrt([b.gain for b in shown])
    kinds = (
        ("named by the verdict", NAMED, [b.named for b in shown]),
        ("fitted in the simulator", CONFIRMED, [b.behind is not None and not b.named for b in shown]),
        ("screened to first order", SCREENED, [b.behind is None for b in shown]),
    )
    for text, colour, wanted in kinds:
        here = np.array(wanted, dtype=bool)
        if here.any():
            axes.barh(rows[here], drawn[here], height=0.7, color=colour, label=text, zorder=2)
    noise = finding.null.max_improvement(finding.screened)
    for p_value, line in ((FREQUENT, ":"), (RARE, "--")):
        axes.axvline(
            np.sqrt(noise.threshold(p_value)),
            color=INK,
            lw=1.1,
            ls=line,
            zorder=3,
            label=f"noise alone exceeds this in {p_value:.0%} of experiments",
        )
    for y, b in zip(rows, shown, strict=True):
        axes.text(
            np.sqrt(b.gain), y, f" {significant(b.gain, 3) if b.gain >= 10 else f'{b.gain:.1f}'}", **_TEXT
        )
    axes.set_yticks(rows, [_named(b) for b in shown])
    for tick, b in zip(axes.get_yticklabels(), shown, strict=True):
        tick.set_fontweight("bold" if b.named else "normal")
        tick.set_color(NAMED if b.named else INK)
        tick.set_linespacing(0.95)
        tick.set_fontsize(tick.get_fontsize() if tick.get_text().count("\n") < 2 else 6.0)
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.set_xlim(0.0, 1.12 * max(float(drawn.max(initial=0.0)), float(np.sqrt(noise.threshold(RARE)))))
    axes.set_title("Evidence", fontsize=10, loc="left", fontweight="bold")
    axes.set_xlabel("explained / standard deviations", fontsize=9)


def _behind(axes: Any, shown: Sequence[Bar]) -> None:
    plain(axes).tick_params(labelleft=False, left=False)
    axes.axvspan(
        0.0, ALTERNATIVE, color=BAND, lw=0, zorder=0, label=f"within {ALTERNATIVE:g}: cannot be separated"
    )
    axes.axvline(ALTERNATIVE, color=INK, lw=1.1, ls="--", zorder=3)
    reach = 30.0
    for y, b in enumerate(shown):
        if b.behind is None:
            continue
        colour = NAMED if b.named else CONFIRMED
        far = b.behind > reach
        x = float(np.clip(b.behind, 0.0, reach))
        axes.plot([0.0, x], [y, y], color=colour, lw=1.5, zorder=2)
        axes.plot(x, y, ">" if far else "o", ms=6, color=colour, zorder=4, clip_on=False)
        text = "best" if b.behind == 0.0 else f"{b.behind:.0f}" if far else f"{b.behind:.1f}"
        axes.text(x + 0.6, y, text, **_TEXT)
    axes.set_xlim(0.0, reach + 4.0)
    axes.set_title("Which one?", fontsize=10, loc="left", fontweight="bold")
    axes.set_xlabel("χ² behind the best", fontsize=9)
    axes.axvline(0.0, color=FAINT, lw=0.6)


def _named(b: Bar) -> str:
    return label_of_causes(b.name) + ("" if b.converged else " (not converged)")


CLEAR = {"fc": "white", "ec": "none", "pad": 0.6, "alpha": 0.85}
_TEXT: dict[str, Any] = {
    "va": "center",
    "ha": "left",
    "fontsize": 7.5,
    "color": INK,
    "zorder": 5,
    "bbox": CLEAR,
}
