"""The commands: learn.train, learn.evaluate, learn.predict, learn.export, learn.bench.

Only the command line is imported here, so that `--help` is fast and needs no torch. Each command imports its
modules when it runs.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from learn._options import Dataset, Device, Plugins, Runs, Threads, Version, load_plugins, set_threads
from learn._terminal import fail, log_to, make_console, plain_errors, print_table, terminable
from learn._training_screen import TrainingScreen
from learn.errors import InputError

app = typer.Typer(
    name="learn",
    help="Surrogates of the poke response: train, evaluate, predict, export, page, bench.",
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)


@app.callback()
def _main(_version: Version = False) -> None:
    pass


# -- train ---------------------------------------------------------------------------------------------------

TRAIN_EXAMPLES = """
[bold]Examples[/bold]

A dataset of few shapes, in minutes:

  python -m learn.train datasets/quick-ogden.zarr --recipe quick

The surrogate on unseen shapes, first of five folds:

  python -m learn.train datasets/paper-ogden.zarr --recipe fast --fold 0

The paper's model and settings, on two GPUs:

  torchrun --nproc-per-node 2 -m learn.train datasets/paper-ogden.zarr --recipe paper

Stopped or killed, the same command with --resume goes on to the same result.

Exit codes: 0 trained, 1 diverged (the last good checkpoint stands), 2 bad input or no room to write,
130 stopped by Ctrl-C.
"""


@app.command(epilog=TRAIN_EXAMPLES)
def train(
    dataset: Annotated[str, typer.Argument(help="Dataset: a folder, a zip or an fsspec URL.")],
    recipe: Annotated[str, typer.Option(help="fast, quick, cegnn, paper, or a YAML file.")] = "fast",
    model: Annotated[
        str | None,
        typer.Option(help="Model, in place of the recipe's: invariant-gnn, invariant-gnn-small, cegnn."),
    ] = None,
    fold: Annotated[int | None, typer.Option(help="Fold, in place of the recipe's: 0 to 4.")] = None,
    split: Annotated[
        str | None, typer.Option(help="Split by shape or by site, in place of the recipe's.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed, in place of the recipe's.")] = None,
    epochs: Annotated[int | None, typer.Option(help="Number of epochs, in place of the recipe's.")] = None,
    out: Annotated[
        Path | None, typer.Option(help="The run's folder. Default: runs/RECIPE-MODEL-LAW-FOLD-SEED.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue an interrupted run.")] = False,
    device: Device = "auto",
    threads: Threads = None,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Train a surrogate on a dataset; the epoch with the lowest validation error is kept."""
    console = make_console()
    with plain_errors():
        import torch

        from learn.data import open_store
        from learn.training import DivergedError, Trainer, load_recipe, make_process_group
        from learn.training.recipe import check_recipe

        load_plugins(plugin or [])
        set_threads(threads)
        os.environ.setdefault("CUBLAS_WORKSPACE_CONFIG", ":4096:8")  # deterministic matrix products on a GPU
        torch.use_deterministic_algorithms(True, warn_only=True)
        changes = {"model": model, "fold": fold, "split": split, "seed": seed, "epochs": epochs}
        given = {key: value for key, value in changes.items() if value is not None}
        chosen = check_recipe({**load_recipe(recipe).model_dump(), **given}, "the command line")
        store = open_store(dataset)
        folder = out or Path("runs") / f"{chosen.name}-{chosen.model}-{store.law}-{chosen.fold}-{chosen.seed}"
        group = make_process_group(device)
        screen = TrainingScreen(console, folder, chosen, quiet=not group.is_main)
        try:
            with terminable(), screen.bar:
                trainer = Trainer(
                    store, chosen, folder, process_group=group, resume=resume, on_progress=screen.update
                )
                screen.begin(trainer)
                trainer.train()
        except DivergedError as error:
            good = "the last good checkpoint stands" if (folder / "last.pt").exists() else "nothing was kept"
            fail(f"diverged: {error}; {good} in {folder}", 1)
        except KeyboardInterrupt:
            next_step = (
                "the same command with --resume goes on"
                if (folder / "last.pt").exists()
                else "no epoch was finished: the same command begins again"
            )
            fail(f"Stopped; {next_step} ({folder}).", 130)
        except OSError as error:
            good = (
                "the last good checkpoint stands: the same command with --resume goes on"
                if (folder / "last.pt").exists()
                else "nothing was kept"
            )
            fail(f"error: cannot write {error.filename or folder}: {error.strerror or error}; {good}")
        finally:
            group.close()
        screen.end()


# -- evaluate ------------------------------------------------------------------------------------------------

EVALUATE_EXAMPLES = """
[bold]Examples[/bold]

  python -m learn.evaluate runs/quick

Several folds, or the surrogate beside the paper's model; the first run's folder gets the report:

  python -m learn.evaluate runs/fast-invariant-gnn-ogden-*-0 runs/paper-cegnn-ogden-0-0

Runs of one fold that differ in seed, alone and together:

  python -m learn.evaluate runs/fast-invariant-gnn-ogden-0-0 runs/fast-invariant-gnn-ogden-0-1 --ensemble

On pokes of another law or recipe than it was trained on:

  python -m learn.evaluate runs/quick --dataset datasets/paper-mooney-rivlin.zarr --transfer

Exit codes: 0 done, 2 bad input.
"""


@app.command(epilog=EVALUATE_EXAMPLES)
def evaluate(
    runs: Runs,
    dataset: Dataset = None,
    transfer: Annotated[
        bool,
        typer.Option(
            "--transfer",
            help="Evaluate on a dataset that the run was not trained on, on what is new to the run: shapes, "
            "or contact points if it was split by site.",
        ),
    ] = False,
    baselines: Annotated[bool, typer.Option(help="Evaluate the baselines too.")] = True,
    clouds: Annotated[bool, typer.Option(help="Evaluate on other point clouds too.")] = True,
    ensemble: Annotated[
        bool,
        typer.Option(
            "--ensemble", help="Average runs that differ only in their seed, and evaluate the average too."
        ),
    ] = False,
    out: Annotated[Path | None, typer.Option(help="Default: evaluation/ in the first run.")] = None,
    device: Device = "auto",
    threads: Threads = None,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Evaluate runs on the test part: tables beside baselines, and report.html."""
    console = make_console()
    with plain_errors():
        from learn.evaluation import evaluate as evaluate_runs
        from learn.evaluation import replaced_text, save_intervals
        from learn.evaluation.report import cautions, tables, verdict, write_report
        from learn.training import check_dataset, load_run, make_device, open_dataset

        load_plugins(plugin or [])
        set_threads(threads)
        log_to(console)
        chosen = make_device(device)
        folder = out or runs[0] / "evaluation"
        if folder.exists() and not folder.is_dir():
            raise InputError(f"--out {folder}: expected the name of a folder, this is a file")
        loaded = [load_run(path) for path in runs]
        store = open_dataset(loaded[0], dataset)
        if transfer and all(run.uuid == store.uuid for run in loaded):
            raise InputError(
                f"--transfer: {store.location} is what was trained on, expected another --dataset"
            )
        for run in loaded if not transfer else ():
            check_dataset(run.uuid, run.folder, store, hint=" (--transfer allows it)")
        found = evaluate_runs(
            loaded, store, baselines=baselines, clouds=clouds, ensemble=ensemble, device=chosen
        )
        write_report(found, folder)
        for title, ((heads, rows), notes) in tables(found).items():
            if rows:
                print_table(console, title, heads, rows)
            else:
                console.print(f"{title}: {' '.join(notes[:-1])}")
        for sentence in (verdict(found), *cautions(found)):
            console.print(sentence)
        console.print(f"{folder}: report.html, tables.json, pictures")
        if transfer:
            return
        # last, so that a run's folder that cannot be written costs no more than the intervals
        for run, intervals in found.intervals:
            text = replaced_text(run, intervals)
            if text is not None:
                console.print(text)
            save_intervals(run, intervals)


# -- predict -------------------------------------------------------------------------------------------------

PREDICT_EXAMPLES = """
[bold]Examples[/bold]

  python -m learn.predict runs/quick datasets/scenes/poke.yaml --out poke

Runs of several seeds as one, the mean of their predictions:

  python -m learn.predict runs/fast-invariant-gnn-ogden-0-0 runs/fast-invariant-gnn-ogden-0-1 poke.yaml

with poke.yaml, for instance:

  site_mm: \\[5, -10]
  depth_mm: 8
  angle_deg: 20
  heading_deg: 45
  shape: cube-18            # or inclusion: {kind: sphere, radius_mm: 8, centre_mm: \\[0, 0, 6]}
  softness: S0.5            # or shear_modulus_kPa: 12

Every prediction states whether the poke is inside the trained ranges.

Exit codes: 0 done, 2 bad input, or outside the training with --strict.
"""


@app.command(epilog=PREDICT_EXAMPLES)
def predict(
    runs: Annotated[
        list[Path], typer.Argument(help="Folder of a run, or of several runs to average.", metavar="RUN...")
    ],
    scene: Annotated[Path, typer.Argument(help="YAML file with the poke.")],
    dataset: Dataset = None,
    strict: Annotated[
        bool,
        typer.Option("--strict", help="Refuse pokes outside the domain of validity (exit code 2)."),
    ] = False,
    out: Annotated[
        Path, typer.Option(help="Folder for displacement.csv, prediction.json and the picture.")
    ] = Path("prediction"),
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Predict one poke, and check whether it is within the domain of validity of the model."""
    console = make_console()
    with plain_errors():
        from learn.predictor import load

        load_plugins(plugin or [])
        predictor = load(list(runs), dataset=dataset)
        answer = predictor.predict(scene, strict=strict)
        answer.save(out)
        for key, value in answer.as_dict().items():
            if isinstance(value, float):
                console.print(f"{key}: {value:.4g}")
        if answer.radius is None:
            console.print(
                "no intervals: learn.evaluate makes them where there are two or more validation pokes"
            )
        elif answer.force_interval is None:
            console.print("no interval of the force, which is predicted to be 0 N or less")
        console.print(answer.verdict)
        for check in answer.checks:
            if not check.inside:
                console.print(f"  {check.text}")
        console.print(f"{out}: displacement.csv, prediction.json, prediction.png")


# -- export --------------------------------------------------------------------------------------------------

EXPORT_EXAMPLES = """
[bold]Example[/bold]

  python -m learn.export runs/quick --out surrogate

encoder.onnx: rigid (n, levels) -> code, vectors, clear, layers: once an interior.
poke.onnx: these four, start, direction, depth, modulus -> displacement, force. SI units.
For the paper's model, in double precision, poke.onnx alone: profile (n, levels), start, direction, depth.
model.json: the points, the indenter, and the domain of validity (trained ranges).

Needs the packages of 'tisim\\[export]'.

Exit codes: 0 written and checked, 2 bad input or a check that failed.
"""


@app.command(epilog=EXPORT_EXAMPLES)
def export(
    run: Annotated[Path, typer.Argument(help="Folder of a run.")],
    dataset: Dataset = None,
    out: Annotated[Path | None, typer.Option(help="Default: onnx/ in the run.")] = None,
    shape: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Shape of the dataset for whose block the files are; needed if the blocks differ.",
            show_default=False,
        ),
    ] = None,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Export a run as ONNX on a grid of the dataset, and check it on test pokes."""
    console = make_console()
    with plain_errors():
        from learn.onnx_bundle import write_bundle
        from learn.predictor import load

        load_plugins(plugin or [])
        predictor = load(run, dataset=dataset)
        files, wrong, pokes = write_bundle(
            predictor.run, predictor.store, out or run / "onnx", predictor.domain, shape=shape
        )
        console.print(
            f"{', '.join(str(path) for path in files)} and model.json; "
            f"{wrong:.1e} off torch over {pokes} pokes"
        )


# -- bench ---------------------------------------------------------------------------------------------------

BENCH_EXAMPLES = """
[bold]Examples[/bold]

  python -m learn.bench runs/quick

The surrogate and the small one beside it:

  python -m learn.bench runs/fast-invariant-gnn-ogden-0-0 runs/fast-invariant-gnn-small-ogden-0-0

Exported with learn.export before, the ONNX files are timed as well.
"""


@app.command(epilog=BENCH_EXAMPLES)
def bench(
    runs: Runs,
    dataset: Dataset = None,
    repeats: Annotated[int, typer.Option(min=3, help="Number of timed calls.")] = 200,
    loader: Annotated[bool, typer.Option(help="Measure the loaders too.")] = True,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Measure the latency of one prediction and the throughput of the loaders (median and best)."""
    console = make_console()
    with plain_errors():
        from learn.benchmark import BATCH, latencies, loader_rates, yardstick
        from learn.training import check_dataset, load_run, open_dataset

        load_plugins(plugin or [])
        loaded = [load_run(run) for run in runs]
        store = open_dataset(loaded[0], dataset, verify=False)
        for run in loaded:
            check_dataset(run.uuid, run.folder, store)
        rows = [row for run in loaded for row in latencies(run, store, repeats)]
        print_table(
            console,
            f"One poke of {store.n_points} points, the interior encoded before",
            ["", "threads", "median ms", "best ms"],
            [[name, threads, f"{median:.2f}", f"{best:.2f}"] for name, threads, median, best in rows],
        )
        median, best = yardstick(repeats)
        load = f", load average {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
        console.print(
            f"beside it, NumPy's product of two 512 x 512 float32 matrices: "
            f"median {median:.2f} ms, best {best:.2f} ms; {os.cpu_count()} cores{load}"
        )
        if loader:
            rates = loader_rates(store)
            memmap = rates["NumPy memmap"]
            print_table(
                console,
                f"Loaders: {store.frames} frames, batches of {BATCH}, random order",
                ["", "frames a second", "relative to a memmap"],
                [[name, f"{rate:.0f}", f"{rate / memmap:.2f}"] for name, rate in rates.items()],
            )


def single(command: Callable[..., Any], epilog: str) -> typer.Typer:
    """Program of a single command, for `python -m learn.COMMAND`."""
    program = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)
    program.command(epilog=epilog)(command)
    return program
