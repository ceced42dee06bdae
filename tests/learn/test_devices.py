"""GPU code paths without a GPU: each model on torch's meta device, and in bfloat16 on the CPU.

On the meta device an operation that mixes devices, or needs a value on the CPU, fails as it would on a GPU.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from learn.benchmark import on_device
from learn.data import Batch, MemoryDataset, Statistics, Store, open_store, statistics
from learn.errors import InputError
from learn.evaluation import evaluate
from learn.models import Model, Scene, make_model, pokes_of, scene_on
from learn.models._encoder import gathered
from learn.training import ProcessGroup, Run, Trainer, load_run, make_device, make_process_group, read_log
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
    """Neighbourhoods from the CPU on another device, as gathers, since meta has no sparse products."""
    found = model.prepare(scene)
    return found and tuple(gathered(part).to(device) for part in found)


def loss(model: Model, scene: Scene, prepared: Any, batch: Batch, store: Store) -> Loss:
    found = model.decode(model.encode(scene, prepared), pokes_of(batch))
    assert found.displacement.shape == batch.displacement.shape
    assert found.displacement.device == found.force.device == batch.depth.device
    return loss_of([(found, batch, scene)], Recipe(), sizes_of(store))


def one_of(batch: Batch) -> Batch:
    return Batch(**{key: value[:1] for key, value in vars(batch).items()})


def sizes_of(store: Store) -> Statistics:
    return statistics(MemoryDataset(store, np.arange(store.frames)).batches(64), store)


@pytest.mark.parametrize("name", MODELS)
def test_a_step_of_training_on_the_meta_device(name: str, store: Store, batch: Batch) -> None:
    """Forward pass, loss, backward pass and optimiser step use one device and no values."""
    model = make_model(name, sizes_of(store))
    scene = scene_on(store.setup, store.profile)
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
    """The mixed-precision branch under the CPU's autocast: losses agree to 5 %, gradients are finite."""
    torch.manual_seed(3)
    model, scene = make_model(name, sizes_of(store)), scene_on(store.setup, store.profile)
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
    """The function that `learn.bench` times on a GPU, here on the CPU."""
    model, scene = make_model("invariant-gnn", sizes_of(store)), scene_on(store.setup, store.profile)
    waits: list[int] = []
    with torch.inference_mode():
        found = on_device(model, scene, pokes_of(batch), "cpu", lambda: waits.append(1))()
        plain = model.decode(model.encode(scene, model.prepare(scene)), pokes_of(batch))
    assert torch.equal(found.displacement, plain.displacement)
    assert torch.equal(found.force, plain.force)
    assert len(waits) == 1


def test_each_process_takes_a_gpu_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """With GPUs, a process of torchrun uses the device of its local rank, and NCCL."""
    done: list[Any] = []
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 2)
    monkeypatch.setattr(torch.cuda, "set_device", done.append)
    monkeypatch.setattr(
        torch.distributed, "init_process_group", lambda name, **given: done.append((name, given))
    )
    for name, value in {"WORLD_SIZE": "8", "RANK": "5", "LOCAL_RANK": "1"}.items():
        monkeypatch.setenv(name, value)
    group = make_process_group()
    own = torch.device("cuda", 1)
    assert (group.rank, group.world, group.device, group.joined) == (5, 8, own, True)
    assert done == [own, ("nccl", {"device_id": own})]
    monkeypatch.setenv("LOCAL_RANK", "2")
    with pytest.raises(InputError, match=r"--nproc-per-node: 3 processes or more .* 2 are here"):
        make_process_group()


@pytest.mark.parametrize("name", ["nonsense", "meta", "cuda:x"])
def test_another_device_is_refused(name: str) -> None:
    with pytest.raises(InputError, match=f"device {name}: expected auto, cpu or cuda"):
        make_device(name)


@pytest.mark.skipif(torch.cuda.is_available(), reason="wants a machine without a GPU")
def test_a_gpu_that_is_not_there_is_refused() -> None:
    with pytest.raises(InputError, match="device cuda: torch sees no GPU here, expected auto or cpu"):
        make_device("cuda")


def test_a_gpu_beyond_those_there_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 2)
    assert make_device("cuda:1").index == 1
    with pytest.raises(InputError, match="device cuda:2: expected a number below 2, of the GPUs"):
        make_device("cuda:2")


def test_one_process_without_torchrun_joins_no_group(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("WORLD_SIZE", raising=False)
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    assert make_process_group().device.type == "cuda"
    group = make_process_group("cpu")
    assert (group.device.type, group.world, group.joined) == ("cpu", 1, False)
    assert group.mean(2.5) == 2.5
    assert not torch.distributed.is_initialized()


GPU = pytest.mark.skipif(not torch.cuda.is_available(), reason="wants a GPU")


def trained_on(device: str, store: Store, folder: Path, **changes: Any) -> Run:
    recipe = Recipe(optimiser="muon", epochs=2, batch=4, point_dropout=0.5, point_jitter=0.0, **changes)
    group = ProcessGroup(0, 1, torch.device(device))
    Trainer(store, recipe, folder, process_group=group).train()
    return load_run(folder)


@GPU
@pytest.mark.parametrize("name", MODELS)
def test_training_on_a_gpu_goes_as_on_the_cpu(name: str, store: Store, tmp_path: Path) -> None:
    """In float32 the losses agree with the CPU's to 1 %, in bfloat16 to 10 %."""
    runs = {
        "cpu": trained_on("cpu", store, tmp_path / "cpu", model=name),
        "cuda": trained_on("cuda", store, tmp_path / "cuda", model=name, mixed_precision=False),
        "bf16": trained_on("cuda", store, tmp_path / "bf16", model=name),
    }
    losses = {key: [line["train_loss"] for line in read_log(run.folder)] for key, run in runs.items()}
    assert losses["cuda"] == pytest.approx(losses["cpu"], rel=0.01)
    assert losses["bf16"] == pytest.approx(losses["cpu"], rel=0.1)
    assert losses["bf16"] != losses["cuda"]


@GPU
def test_evaluation_on_a_gpu_is_that_of_the_cpu(store: Store, tmp_path: Path) -> None:
    run = trained_on("cuda", store, tmp_path / "run")
    here, there = (evaluate([run], store, baselines=False, device=device) for device in ("cpu", "cuda"))
    assert here.predictions is not None
    assert there.predictions is not None
    np.testing.assert_allclose(there.predictions.predicted, here.predictions.predicted, atol=1e-7)
    np.testing.assert_allclose(there.predictions.force_predicted, here.predictions.force_predicted, rtol=1e-4)
    on_grid = [found.clouds["1024, the grid"]["mean"].mean for found in (here, there)]
    assert on_grid[1] == pytest.approx(on_grid[0], rel=1e-3)
    assert max(error.displacement_mm for error in there.symmetry.values()) < 1e-3
    assert next(run.model.parameters()).device.type == "cpu"
