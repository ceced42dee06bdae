"""What a GPU would run, without one: each model on torch's meta device, and in bfloat16 on the CPU.

On the meta device an operation that mixes devices, or needs a value on the CPU, fails as it would on a GPU.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch

from learn.benchmark import on_device
from learn.data import Batch, MemoryDataset, Statistics, Store, open_store, statistics
from learn.models import Model, Scene, make_model, pokes_of, scene_of
from learn.models._encoder import gathered
from learn.training.process_group import make_process_group
from learn.training.recipe import Loss, Recipe, loss_of
from tests.learn.small_store import write_store

MODELS = ("invariant-gnn", "invariant-gnn-small", "cegnn")


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    return open_store(write_store(tmp_path_factory.mktemp("devices") / "s.zarr", frames=10))


@pytest.fixture(scope="module", autouse=True)
def _one_thread() -> None:
    torch.set_num_threads(1)


@pytest.fixture(scope="module")
def batch(store: Store) -> Batch:
    return MemoryDataset(store, np.array([9, 34, 59, 119])).__getitems__([0, 1, 2, 3])


def prepared_on(model: Model, scene: Scene, device: str) -> Any:
    """Neighbourhoods are looked up on the CPU, then moved. By gathering: meta has no sparse products."""
    found = model.prepare(scene)
    return found and tuple(gathered(part).to(device) for part in found)


def loss(model: Model, scene: Scene, prepared: Any, batch: Batch, store: Store) -> Loss:
    found = model.decode(model.encode(scene, prepared), pokes_of(batch))
    assert found.displacement.shape == batch.displacement.shape
    assert found.displacement.device == found.force.device == batch.depth.device
    return loss_of(found, batch, scene, Recipe(), sizes_of(store))


def one_of(batch: Batch) -> Batch:
    return Batch(**{key: value[:1] for key, value in vars(batch).items()})


def sizes_of(store: Store) -> Statistics:
    return statistics(MemoryDataset(store, np.arange(store.frames)).batches(64), store)


@pytest.mark.parametrize("name", MODELS)
def test_a_step_of_training_on_the_meta_device(name: str, store: Store, batch: Batch) -> None:
    """Forward, loss, backward and the optimiser's step touch no other device and ask for no value."""
    model = make_model(name, sizes_of(store))
    scene = scene_of(store)
    prepared = prepared_on(model, scene, "meta")
    there = model.to("meta")
    optimiser = torch.optim.AdamW(there.parameters())
    total = loss(there, scene.to("meta"), prepared, batch.to("meta"), store).total
    assert total.device.type == "meta"
    total.backward()
    torch.nn.utils.clip_grad_norm_(there.parameters(), 1.0, foreach=False)
    optimiser.step()
    assert all(p.grad is not None and p.grad.device.type == "meta" for p in there.parameters())


@pytest.mark.parametrize("name", MODELS)
def test_bfloat16_is_as_near_as_its_digits(name: str, store: Store, batch: Batch) -> None:
    """The branch of mixed precision, by the CPU's autocast: no operation mixes types."""
    torch.manual_seed(3)
    model, scene = make_model(name, sizes_of(store)), scene_of(store)
    prepared = model.prepare(scene)
    batch = batch if name != "cegnn" else one_of(batch)  # it takes ten times as long
    plain = loss(model, scene, prepared, batch, store).total
    with torch.autocast("cpu", torch.bfloat16):
        mixed = loss(model, scene, prepared, batch, store).total
    mixed.backward()
    assert float(mixed.detach()) == pytest.approx(float(plain.detach()), rel=0.05)
    assert float(mixed.detach()) != float(plain.detach())
    assert all(torch.isfinite(p.grad).all() for p in model.parameters() if p.grad is not None)


def test_answers_on_a_device_are_those_of_the_model(store: Store, batch: Batch) -> None:
    """What `learn.bench` times on a GPU, on the CPU."""
    model, scene = make_model("invariant-gnn", sizes_of(store)), scene_of(store)
    waits: list[int] = []
    with torch.inference_mode():
        found = on_device(model, scene, pokes_of(batch), "cpu", lambda: waits.append(1))()
        plain = model.decode(model.encode(scene, model.prepare(scene)), pokes_of(batch))
    assert torch.equal(found.displacement, plain.displacement)
    assert torch.equal(found.force, plain.force)
    assert len(waits) == 1


def test_each_process_takes_a_gpu_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """What torchrun starts where there are GPUs: the local rank's device, and NCCL between them."""
    done: list[Any] = []
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    monkeypatch.setattr(torch.cuda, "set_device", done.append)
    monkeypatch.setattr(torch.distributed, "init_process_group", done.append)
    for name, value in {"WORLD_SIZE": "8", "RANK": "5", "LOCAL_RANK": "1"}.items():
        monkeypatch.setenv(name, value)
    group = make_process_group()
    assert (group.rank, group.world, group.device) == (5, 8, torch.device("cuda", 1))
    assert done == [torch.device("cuda", 1), "nccl"]
    monkeypatch.setenv("WORLD_SIZE", "1")
    done.clear()
    assert make_process_group().device.type == "cuda"
    assert make_process_group("cpu").device.type == "cpu"
    assert done == []
