"""The outline model in a fit: names and signs of nuisances, one trial left out, a failing mesh.

The beams are made on the model's mesh without noise: the tests are not about the simulator.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from made_beams import made

import tisim
from calibration.experiment import Experiment, read
from calibration.experiment.model import BeamTrial
from calibration.measurements.objective import ModelObjective
from calibration.measurements.outlines import COARSE
from calibration.measurements.outlines._admitted import admitted
from calibration.measurements.outlines._solutions import SolutionCache
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.simulators import TISIM
from calibration.parameters import parametrisation
from calibration.study.measurements import measurements

SHEAR = 25e3
TRUTH = tisim.material_from_moduli(
    "neo-hookean", shear_modulus=SHEAR, bulk_modulus=300 * SHEAR, density=1000.0
)
LAW = parametrisation("neo-hookean")
U = np.log([SHEAR, 300.0])
BARE = replace(TISIM, reference=None)


@pytest.fixture(scope="module")
def experiment(tmp_path_factory: pytest.TempPathFactory) -> Experiment:
    folder = tmp_path_factory.mktemp("fit")
    return read(
        made(
            folder,
            TRUTH,
            lengths_mm=(50.0, 80.0),
            photographs=2,
            noise=0.0,
            layer=COARSE.axial_element_size,
            rings=COARSE.radial_elements,
        )
    )


def outlines(experiment: Experiment, **options: object) -> ModelObjective[OutlineModel]:
    found = measurements(experiment, "S0", LAW, workers=1, **options).outlines  # type: ignore[arg-type]
    assert found is not None
    return found


def shorter(trial: BeamTrial) -> BeamTrial:
    return replace(trial, free_length=trial.free_length - trial.free_length_sd)


def thinner(trial: BeamTrial) -> BeamTrial:
    assert isinstance(trial.section, tisim.Circle)
    return replace(trial, section=replace(trial.section, radius=trial.section.radius - trial.section_sd[0]))


def lifted(trial: BeamTrial) -> BeamTrial:
    """The trial with its first photograph shifted upwards by one standard deviation."""
    first = trial.captures[0]
    assert first.outline is not None
    up = np.array([0.0, first.outline.registration.shift])
    traced = replace(first.outline, upper=first.outline.upper + up, lower=first.outline.lower + up)
    return replace(trial, captures=(replace(first, outline=traced), *trial.captures[1:]))


@pytest.mark.parametrize(
    ("stated", "name"),
    [
        (shorter, "free length of S0-cantilever-80"),
        (thinner, "radius of S0"),
        (lifted, "shift z of S0-cantilever-80 at 10 s"),
    ],
)
def test_a_nuisance_is_positive_where_its_quantity_is_larger_than_stated(
    experiment: Experiment, stated: Callable[[BeamTrial], BeamTrial], name: str
) -> None:
    before = outlines(experiment, simulator=BARE)
    assert before.linearise(U)
    as_stated = before.nuisances(U)
    trials = [t for t in experiment.trials if isinstance(t, BeamTrial)]
    changed = [stated(t) if name.startswith("radius") or t.id in name else t for t in trials]
    after = outlines(replace(experiment, trials=tuple(changed)), simulator=BARE)
    assert after.linearise(U)
    found = {n: b - as_stated[n] for n, b in after.nuisances(U).items()}
    assert 0.2 < found[name] < 1.2
    assert max(found, key=lambda n: abs(found[n])) == name


def test_an_error_that_photographs_share_moves_them_together(experiment: Experiment) -> None:
    """It is one nuisance, so that more photographs do not reduce it."""

    def stated(own: bool) -> Experiment:
        def of(trial: BeamTrial) -> BeamTrial:
            captures = []
            for c in trial.captures:
                assert c.outline is not None
                error = c.outline.registration
                nothing = replace(error, shift=0.0, roll=0.0, scale=0.0)
                parts = {"registration": error, "shared": nothing} if own else {
                    "registration": nothing, "shared": error
                }  # fmt: skip
                captures.append(replace(c, outline=replace(c.outline, **parts)))
            return replace(trial, captures=tuple(captures), free_length_sd=0.0)

        beams = tuple(of(t) for t in experiment.trials if isinstance(t, BeamTrial))
        return replace(experiment, trials=beams)

    own, shared = outlines(stated(True), simulator=BARE), outlines(stated(False), simulator=BARE)
    assert own.linearise(U)
    assert shared.linearise(U)
    a, b = own.model.noise, shared.model.noise
    for what in ("shift x", "shift z", "roll", "scale"):
        mine = [k for k, name in enumerate(a.names) if name.startswith(f"{what} of ")]
        assert len(mine) == 4
        (one,) = (k for k, name in enumerate(b.names) if name.startswith(f"{what} of "))
        assert b.names[one] == f"{what} of all photographs"
        np.testing.assert_allclose(b.columns[:, one], a.columns[:, mine].sum(axis=1), atol=1e-12)


def test_trials_of_one_specimen_share_a_dimension_if_their_section_is_one(experiment: Experiment) -> None:
    short, long = (t for t in experiment.trials if isinstance(t, BeamTrial))
    belief = experiment.materials["S0"]
    found = [n for n in admitted([short, long], belief) if n.quantity == "radius"]
    assert [(n.name, n.trials) for n in found] == [("radius of S0", (0, 1))]
    unnamed = [replace(t, specimen=None) for t in (short, long)]  # one specimen of the material
    found = [n for n in admitted(unnamed, belief) if n.quantity == "radius"]
    assert [(n.name, n.trials) for n in found] == [("radius of S0", (0, 1))]
    strip = replace(long, section=tisim.Rectangle(width=0.02, height=0.018), section_sd=(5e-5, 6e-5))
    batch = [replace(t, specimen="batch 1") for t in (short, strip)]
    found = [n for n in admitted(batch, belief) if n.quantity in ("radius", "width", "height")]
    assert [(n.quantity, n.trials, n.sd) for n in found] == [
        ("radius", (0,), short.section_sd[0]),
        ("width", (1,), 5e-5),
        ("height", (1,), 6e-5),
    ]
    assert len({n.name for n in found}) == 3


def test_a_density_that_is_larger_than_stated_is_positive(experiment: Experiment) -> None:
    belief = experiment.materials["S0"]
    assert belief.density is not None
    lighter = replace(belief, density=belief.density - belief.density_sd)
    other = outlines(replace(experiment, materials={"S0": lighter}), simulator=BARE)
    assert other.linearise(U)
    assert 0.2 < other.nuisances(U)["density of S0"] < 1.2


def test_one_trial_alone_and_the_others(experiment: Experiment) -> None:
    whole = outlines(experiment, simulator=BARE)
    assert whole.linearise(U)
    own = whole.model.of_trial(0)
    alone, rest = whole.subset(own), whole.subset(own, others=True)
    assert alone.points + rest.points == whole.points
    v = U + 0.05
    for part, trial in ((alone, 0), (rest, 1)):
        assert part.linearise(v)  # nothing is updated
        assert part.model.noise.columns is whole.model.noise.columns
        seen = part.model.seen(part.state(v))
        assert [s.photograph.beam for s in seen] == [trial] * 2
        (rows,) = part.residuals(v[None])
        assert len(rows) == part.points
        left = part.model.registered(part.state(v))
        assert [bool(np.isfinite(x).all()) for x in left] == [k // 2 == trial for k in range(4)]
    # nuisances fitted to one photograph alone are not constrained by the others
    assert np.sum(alone.residuals(v[None]) ** 2) < np.sum(whole.residuals(v[None]) ** 2)


def test_a_law_without_equilibrium_on_the_finer_mesh_is_tried_once(
    experiment: Experiment, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = []

    def fails(self: SolutionCache, *_: object, **__: object) -> tuple[list[tisim.Result], str]:
        tried.append(self)
        return [], "no equilibrium of S0-cantilever-80 on the finer mesh that corrects"

    monkeypatch.setattr(SolutionCache, "fine", fails)
    found = outlines(experiment)
    assert found.linearise(U, rough=True)
    assert (tried, found.shortcomings()) == ([], [])
    assert found.linearise(U)
    assert found.linearise(U)
    assert len(tried) == 1
    (note,) = found.shortcomings()
    assert note.startswith("no equilibrium of S0-cantilever-80")


def test_the_longest_is_tried_first_and_no_other_after_it(
    experiment: Experiment, monkeypatch: pytest.MonkeyPatch
) -> None:
    solved = []

    def none(beams: list[tisim.Beam], *_: object) -> list[None]:
        solved.append([round(1e3 * b.length) for b in beams])
        return [None for _ in beams]

    found = outlines(experiment)
    monkeypatch.setattr("calibration.measurements.outlines._solutions.simulated", none)
    state = found.state(U)
    assert found.model.solutions.fine(state, COARSE, one_by_one=True)[1].startswith(
        "no equilibrium of S0-cantilever-80 on"
    )
    assert solved == [[80]]
    words = found.model.solutions.fine(state, COARSE)[1]
    assert words.startswith("no equilibrium of S0-cantilever-50, S0-cantilever-80 on")
