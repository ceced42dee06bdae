"""Models: exact symmetries of the invariant ones, any point cloud, and their lack in the published scheme."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch
from scipy.stats import ortho_group
from torch import Tensor

from learn.data import MemoryDataset, Statistics, Store, open_store, statistics
from learn.errors import InputError
from learn.evaluation import predict_part, summarise
from learn.models import (
    InvariantGnn,
    Model,
    Pokes,
    Scene,
    Scenes,
    make_model,
    make_scene,
    pokes_of,
    scene_on,
)
from learn.models._encoder import stencil
from learn.models.cegnn import Cegnn, _neighbours
from learn.models.single_poke import SinglePoke
from tests.learn.small_store import write_store


@pytest.fixture(scope="module", autouse=True)
def _one_thread() -> None:
    torch.set_num_threads(1)


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    return open_store(write_store(tmp_path_factory.mktemp("models") / "s.zarr", frames=10))


@pytest.fixture(scope="module")
def sizes(store: Store) -> Statistics:
    return statistics(MemoryDataset(store, np.arange(store.frames)).batches(64), store)


@pytest.fixture(scope="module")
def pokes(store: Store) -> Pokes:
    return pokes_of(MemoryDataset(store, np.array([9, 34, 59, 119])).__getitems__([0, 1, 2, 3]))


def _model(name: str, sizes: Statistics) -> Model:
    torch.manual_seed(5)
    model = make_model(name, sizes).eval()
    with torch.no_grad():
        for parameter in model.parameters():
            parameter.mul_(1.7)  # outputs of a trained model's size, all paths active
    return model


def _turned(scene: Scene, pokes: Pokes, turn: Tensor, shift: Tensor) -> tuple[Scene, Pokes]:
    return (
        dataclasses.replace(scene, points=scene.points @ turn.T + shift, normals=scene.normals @ turn.T),
        dataclasses.replace(pokes, start=pokes.start @ turn.T + shift, direction=pokes.direction @ turn.T),
    )


def _error_mm(model: Model, scene: Scene, pokes: Pokes, turn: Tensor, shift: Tensor) -> tuple[float, float]:
    """Largest violation of equivariance, of the displacement [mm] and of the force [relative]."""
    with torch.no_grad():
        still, moved = model(scene, pokes), model(*_turned(scene, pokes, turn, shift))
    apart = moved.displacement.double() - still.displacement.double() @ turn.T
    return float(apart.norm(dim=2).max()) * 1e3, float((moved.force / still.force - 1).abs().max())


@pytest.mark.parametrize(
    ("name", "seed"), [*(("invariant-gnn", k) for k in range(4)), ("invariant-gnn-small", 4)]
)
def test_ours_turns_mirrors_and_moves_with_the_scene(
    store: Store, sizes: Statistics, pokes: Pokes, name: str, seed: int
) -> None:
    """Rotations about any axis, reflections, and translations by metres, in float32."""
    random = np.random.default_rng(seed)
    turn = torch.from_numpy(ortho_group.rvs(3, random_state=random))  # half of them reflections
    shift = torch.from_numpy(random.uniform(-3, 3, 3))
    model, scene = _model(name, sizes), scene_on(store.setup, store.profile)
    model.warm_start(MemoryDataset(store, np.arange(0, store.frames, 9)).batches(8), Scenes.of(store))
    with torch.no_grad():
        size = float(model(scene, pokes).displacement.norm(dim=2).max()) * 1e3
    assert size > 1  # mm, so that the bound below is meaningful
    apart, force = _error_mm(model, scene, pokes, turn, shift)
    assert apart < 1e-5
    assert force < 1e-5


def test_the_closed_form_alone_has_skill_on_another_shape(store: Store, sizes: Statistics) -> None:
    model = make_model("invariant-gnn", sizes)
    seen, unseen = (np.flatnonzero((store.shape[store.frame_poke] == 2) == last) for last in (False, True))
    model.warm_start(MemoryDataset(store, seen[::3]).batches(8), Scenes.of(store))
    assert isinstance(model, InvariantGnn)
    with torch.no_grad():
        model.coefficients.weight.zero_()
        model.coefficients.bias.zero_()
    found = summarise(predict_part(model, Scenes.of(store), MemoryDataset(store, unseen[::4])))
    assert found["skill"].mean > 0.8


def test_the_published_scheme_does_not(store: Store, sizes: Statistics, pokes: Pokes) -> None:
    turn = torch.tensor([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]], dtype=torch.float64)
    apart, force = _error_mm(
        _model("cegnn", sizes), scene_on(store.setup, store.profile), pokes, turn, torch.zeros(3)
    )
    assert apart > 1e-3
    assert force > 1e-3


def test_the_published_head_acts_on_layers_and_path_joined(sizes: Statistics) -> None:
    model = make_model("cegnn", sizes)
    assert isinstance(model, Cegnn)
    layers, path = torch.randn(2, 7, 12), torch.randn(2, 518)
    joined = torch.cat([layers, path[:, None].expand(2, 7, 518)], dim=2)
    torch.testing.assert_close(model._head(layers, path), model.head(joined), rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("digits", [torch.float32, torch.float64])
def test_of_equally_near_points_the_first_are_neighbours(digits: torch.dtype) -> None:
    line = np.arange(6) * 0.3
    grid = np.stack([*np.meshgrid(line, line, indexing="ij"), np.zeros((6, 6))], axis=-1).reshape(-1, 3)
    distance = np.linalg.norm(grid[:, None] - grid[None], axis=2).round(6)
    nearest = np.argsort(distance, axis=1, kind="stable")[:, :5]
    found = _neighbours(torch.from_numpy(grid).to(digits)[None])[0]
    np.testing.assert_array_equal(np.sort(found.numpy(), axis=1), np.sort(nearest, axis=1))


def test_answers_do_not_depend_on_the_order_of_points_or_on_other_pokes(
    store: Store, sizes: Statistics, pokes: Pokes
) -> None:
    model, scene = _model("invariant-gnn", sizes), scene_on(store.setup, store.profile)
    order = np.random.default_rng(0).permutation(1024)
    mixed = make_scene(
        points=store.setup.points[order],
        normals=store.setup.normals[order],
        profile=store.profile[:, order],
        level_depth=store.setup.level_depth,
        rod_radius=store.rod_radius,
        rod_edge=store.setup.rod_edge,
    )
    with torch.no_grad():
        plain, shuffled = model(scene, pokes), model(mixed, pokes)
        alone = model(scene, Pokes(**{k: v[2:3] for k, v in vars(pokes).items()}))
    torch.testing.assert_close(shuffled.displacement, plain.displacement[:, order], atol=1e-8, rtol=1e-5)
    torch.testing.assert_close(alone.displacement[0], plain.displacement[2], atol=1e-8, rtol=1e-5)
    torch.testing.assert_close(alone.force[0], plain.force[2])


@pytest.mark.parametrize("name", ["invariant-gnn", "invariant-gnn-small"])
def test_one_poke_at_a_time_gives_the_same(store: Store, sizes: Statistics, pokes: Pokes, name: str) -> None:
    """`SinglePoke` gives the displacement to rounding, near the indenter and far from it."""
    model, scene = _model(name, sizes), scene_on(store.setup, store.profile)
    assert isinstance(model, InvariantGnn)
    model.warm_start(MemoryDataset(store, np.arange(0, store.frames, 9)).batches(8), Scenes.of(store))
    _compare(model, scene, pokes)


def test_one_poke_at_a_time_on_a_surface_that_is_not_level(
    store: Store, sizes: Statistics, pokes: Pokes
) -> None:
    """The slopes have three components."""
    model = _model("invariant-gnn", sizes)
    assert isinstance(model, InvariantGnn)
    turn = torch.linalg.qr(torch.tensor([[2.0, 1, 1], [0, 3, 1], [1, 0, 2]], dtype=torch.float64)).Q
    scene, pokes = _turned(scene_on(store.setup, store.profile), pokes, turn, torch.zeros(3).double())
    _compare(model, scene, pokes)


def _compare(model: InvariantGnn, scene: Scene, pokes: Pokes) -> None:
    with torch.no_grad():
        encoded = model.encode(scene, model.prepare(scene))
        found = model.decode(encoded, pokes)
    for k in (0, 3):
        one = SinglePoke(model, encoded, int(scene.rigid_index[pokes.geometry[k]]))
        rod = (pokes.start[k].numpy(), pokes.direction[k].numpy(), float(pokes.depth[k]))
        u, force = one(*rod, float(pokes.modulus[k]))
        truth = found.displacement[k].numpy()
        assert np.abs(u - truth).max() < 3e-6 * np.abs(truth).max()
        assert force == pytest.approx(float(found.force[k]), rel=1e-5)
        assert np.array_equal(one(*rod, float(pokes.modulus[k]))[0], u)
        for features in (one._fixed_rows, one._moving_rows):  # products of subnormal numbers are slow
            size = features.abs()
            assert not bool(((size > 0) & (size < torch.finfo(torch.float32).tiny)).any())


@pytest.mark.parametrize("name", ["invariant-gnn", "invariant-gnn-small"])
def test_what_a_contact_keeps_is_not_kept_for_another(
    store: Store, sizes: Statistics, pokes: Pokes, name: str
) -> None:
    """Deeper from one contact, then another, and back: each answer is a new predictor's, bit by bit."""
    model, scene = _model(name, sizes), scene_on(store.setup, store.profile)
    assert isinstance(model, InvariantGnn)
    with torch.no_grad():
        encoded = model.encode(scene, model.prepare(scene))
    one = SinglePoke(model, encoded)
    contacts = [(pokes.start[k].numpy(), pokes.direction[k].numpy()) for k in (0, 1, 3)]
    other = contacts[0][0] + np.array([3e-3, 0, 0])
    course = [*contacts, contacts[0], (other, contacts[0][1]), (other, contacts[1][1])]
    for contact, depth in ((contact, depth) for contact in course for depth in (1e-3, 4e-3, 2e-3)):
        u, force = one(*contact, depth, 2e4)
        again, same = SinglePoke(model, encoded)(*contact, depth, 2e4)
        assert np.array_equal(u, again)
        assert force == same


def test_any_cloud_gives_nearly_the_same_field(store: Store, sizes: Statistics, pokes: Pokes) -> None:
    """A quarter of the points move nearly as among all points: messages are means, not sums."""
    model, scene = _model("invariant-gnn", sizes), scene_on(store.setup, store.profile)
    some = np.arange(1024).reshape(32, 32)[::2, ::2].reshape(-1)
    sparse = make_scene(
        points=store.setup.points[some],
        normals=store.setup.normals[some],
        profile=store.profile[:, some],
        level_depth=store.setup.level_depth,
        rod_radius=store.rod_radius,
        rod_edge=store.setup.rod_edge,
    )
    with torch.no_grad():
        whole, part = model(scene, pokes).displacement[:, some], model(sparse, pokes).displacement
    wrong = (part - whole).norm(dim=2).mean() / whole.norm(dim=2).mean()
    assert wrong < 0.25
    few = make_scene(
        points=store.setup.points[:3],
        normals=store.setup.normals[:3],
        profile=store.profile[:, :3],
        level_depth=store.setup.level_depth,
        rod_radius=store.rod_radius,
        rod_edge=store.setup.rod_edge,
    )
    assert bool(torch.isfinite(model(few, pokes).displacement).all())


def test_force_is_proportional_to_the_modulus_but_for_what_is_learned_of_it(
    store: Store, sizes: Statistics, pokes: Pokes
) -> None:
    model, scene = _model("invariant-gnn", sizes), scene_on(store.setup, store.profile)
    with torch.no_grad():
        one = model(scene, pokes)
        two = model(scene, dataclasses.replace(pokes, modulus=pokes.modulus * 1.0001))
    torch.testing.assert_close(two.force / one.force, torch.full((4,), 1.0001), atol=1e-3, rtol=0)
    assert bool((one.force > 0).all())


def test_where_levels_scale_with_the_modulus_the_displacement_does_not_depend_on_it(
    store: Store, pokes: Pokes
) -> None:
    """For a law without gravity the dependence is known and is not learned."""
    alike = dataclasses.replace(store, attributes={**store.attributes, "scales_with_modulus": True})
    sizes = statistics(MemoryDataset(alike, np.arange(alike.frames)).batches(64), alike)
    model, scene = _model("invariant-gnn", sizes), scene_on(alike.setup, alike.profile)
    with torch.no_grad():
        one = model(scene, pokes)
        two = model(scene, dataclasses.replace(pokes, modulus=pokes.modulus * 7))
    assert torch.equal(one.displacement, two.displacement)
    torch.testing.assert_close(two.force, 7 * one.force, rtol=1e-6, atol=0)


def test_force_and_displacement_go_to_zero_in_proportion_at_first_contact(
    store: Store, sizes: Statistics, pokes: Pokes
) -> None:
    """Force and displacement are linear in small depths, and 0 without contact."""
    model, scene = _model("invariant-gnn", sizes), scene_on(store.setup, store.profile)
    assert isinstance(model, InvariantGnn)
    with torch.no_grad():
        encoded = model.encode(scene, model.prepare(scene))
    one = SinglePoke(model, encoded, int(scene.rigid_index[pokes.geometry[0]]))
    rod = pokes.start[0].numpy(), pokes.direction[0].numpy()
    found = [one(*rod, depth, 2e4) for depth in (1e-6, 2e-6, 1e-5)]
    stiffness = [force / depth for (_, force), depth in zip(found, (1e-6, 2e-6, 1e-5), strict=True)]
    assert stiffness[0] == pytest.approx(stiffness[1], rel=0.02)
    assert stiffness[0] == pytest.approx(stiffness[2], rel=0.2)
    shares = [np.abs(u).max() / depth for (u, _), depth in zip(found, (1e-6, 2e-6, 1e-5), strict=True)]
    assert shares[0] == pytest.approx(shares[1], rel=0.1)
    for depth in (0.0, -1e-3):
        u, force = one(*rod, depth, 2e4)
        assert force == 0.0
        assert not u.any()
        there = dataclasses.replace(pokes, depth=torch.full_like(pokes.depth, depth))
        with torch.no_grad():
            batch = model.decode(encoded, there)
        assert not batch.displacement.any()
        assert not batch.force.any()


def test_more_points_near_the_rod_do_not_change_the_answer(
    store: Store, sizes: Statistics, pokes: Pokes
) -> None:
    """Points are weighted by their area, as a locally refined surface mesh requires."""
    model, scene = _model("invariant-gnn", sizes), scene_on(store.setup, store.profile)
    some = np.random.default_rng(0).uniform(-8e-3, 8e-3, (600, 2)) + pokes.start[0, :2].numpy()
    points = np.concatenate(
        [store.setup.points, np.column_stack([some, np.full(600, store.setup.points[0, 2])])]
    )
    wrong = {}
    first = Pokes(**{k: v[:1] for k, v in vars(pokes).items()})
    with torch.no_grad():
        whole = model(scene, first)
        for weighted in (True, False):
            cloud = scene_on(store.setup, store.profile, points)
            if not weighted:
                cloud = dataclasses.replace(cloud, area=torch.ones_like(cloud.area))
            apart = model(cloud, first).displacement[:, :1024] - whole.displacement
            wrong[weighted] = float(apart.norm(dim=2).mean() / whole.displacement.norm(dim=2).mean())
    assert wrong[True] < 0.4 * wrong[False]


def test_stencil_is_a_mean_and_a_slope() -> None:
    """The mean of a constant is the constant; its slope is 0 at a point with a symmetric neighbourhood.

    The slope of a linear function has the direction of its gradient.
    """
    x = np.arange(9.0)
    points = np.stack([*(g.reshape(-1) for g in np.meshgrid(x, x)), np.zeros(81)], axis=1)
    s = stencil(points, 2.1, np.ones(81))
    one = torch.ones(81, 1)
    torch.testing.assert_close(s.mean(one), one)
    slope = s.slope(torch.from_numpy(points[:, :1]).float()).reshape(3, 81)
    middle = 40
    assert slope[0, middle] > 0.1
    assert abs(slope[1, middle]) < 1e-6
    assert float(s.slope(one).reshape(3, 81)[:, middle].abs().max()) < 1e-6


def test_gradients_of_the_sparse_product_are_right() -> None:
    points = np.random.default_rng(0).uniform(size=(12, 3))
    s = stencil(points, 0.6, np.ones(12))
    values = torch.randn(12, 2, requires_grad=True)
    weight = torch.randn(36, 2)
    (s.slope(values) * weight).sum().backward()
    assert values.grad is not None
    torch.testing.assert_close(values.grad, s.slope.matrix.to_dense().T @ weight, atol=1e-5, rtol=1e-4)


def test_unknown_model() -> None:
    with pytest.raises(InputError, match="expected one of cegnn, invariant-gnn, invariant-gnn-small"):
        make_model("best", Statistics(1, 1, 1, 1, 1, 1, 1, 1))


def test_scene_of_some_interiors_keeps_their_indices(store: Store, sizes: Statistics, pokes: Pokes) -> None:
    model, scene = _model("invariant-gnn", sizes), scene_on(store.setup, store.profile)
    part = scene.only(pokes.geometry[3:].numpy())
    assert len(part.rigid) == 1 < len(scene.rigid)
    last = Pokes(**{k: v[3:] for k, v in vars(pokes).items()})
    with torch.no_grad():
        torch.testing.assert_close(model(part, last).displacement, model(scene, last).displacement)
