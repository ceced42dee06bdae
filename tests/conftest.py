"""Configuration of all tests: run the longest files first; report core-seconds per file and per package."""

from __future__ import annotations

import os
import re
import resource
import signal
from collections import Counter
from collections.abc import Generator
from pathlib import Path
from typing import Any

import hypothesis
import psutil
import pytest

HERE = Path(__file__).parent
# Functions called without a number of processes start none: pytest-xdist occupies the cores, and each process
# imports everything and compiles its own kernels, at several times the cost of most tests.
os.environ.setdefault("LOKY_MAX_CPU_COUNT", "1")
# Threads of BLAS and OpenMP wait for each other: with two threads per process on two busy cores some tests
# took a hundred times as long.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
# The same random examples in every run, so that a failure is due to the commit. To draw new examples:
# HYPOTHESIS_PROFILE=explore python -m pytest ...
hypothesis.settings.register_profile("fixed", derandomize=True, deadline=None)
hypothesis.settings.register_profile("explore", deadline=None, max_examples=1000)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "fixed"))
# pytest-xdist distributes whole files: a long file that starts late would leave the other processes idle. The
# summary at the end of a run lists the long files.
LONG = (
    "packaging/test_pages.py",
    "calibration/study/test_fit_and_diagnosis.py",
    "blind/test_beams.py",
    "tisim/test_time_in_scenes.py",
    "tisim/test_law_registry.py",
    "calibration/study/test_fit_command.py",
    "learn/evaluation/test_report.py",
    "tisim/test_poke_back.py",
    "tisim/test_poke_cover.py",
    "calibration/indentation/test_poke_mesh_error.py",
    "factory/test_interruption.py",
    "factory/test_timed.py",
    "calibration/photo/test_trace_photo.py",
    "tisim/test_poke_protocol.py",
    "tisim/test_poke_turns.py",
    "calibration/photo/test_reconstruct_command.py",
    "learn/test_damage.py",
    "blind/test_solver.py",
    "factory/test_store.py",
    "tisim/test_press.py",
    "learn/test_commands.py",
    "learn/page/test_browser.py",
    "factory/test_command.py",
    "calibration/interface/test_commands.py",
    "tisim/test_parts_point.py",
    "calibration/indentation/test_poke_objective.py",
    "calibration/study/test_error_bars.py",
    "tisim/test_dynamics.py",
    "calibration/diagnosis_release/test_bar_verdicts.py",
    "blind/test_coupons.py",
    "tisim/test_beam_steps.py",
    "tisim/test_beam_reference.py",
    "calibration/diagnosis/test_diag_beam_model.py",
    "calibration/diagnosis/test_diag_early_stop.py",
    "learn/test_training.py",
    "learn/test_pokes.py",
    "learn/test_blocks.py",
    "learn/test_adaptation.py",
    "learn/test_timed.py",
    "factory/test_assembly.py",
    "factory/test_own_blocks.py",
    "factory/test_damage_store.py",
    "tisim/test_simulate_batch.py",
    "tisim/test_laws.py",
    "calibration/time/test_fit_over_time.py",
    "tisim/test_assembly.py",
    "tisim/test_parts_registry.py",
    "calibration/compression/test_press_fit.py",
    "calibration/indentation/test_poke_fit.py",
    "calibration/time/test_memory_stress.py",
    "calibration/table/test_calibration_table.py",
    "calibration/metrics/test_metrics_distance.py",
    "calibration/photo/test_bad_photographs.py",
    "mesh/test_poke_block.py",
    "factory/test_adding.py",
)


def pytest_configure(config: pytest.Config) -> None:
    """Restore the default handling of SIGINT, set the order of files, and register the core-second count.

    A process started in the background ignores Ctrl-C, and so would the programs whose Ctrl-C is tested.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    config.option.loadscopereorder = False  # that order is by the number of tests; `LONG` is by time
    config.pluginmanager.register(_CoreSeconds(config))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    place = {HERE / name: i for i, name in enumerate(LONG)}
    items.sort(key=lambda item: place.get(item.path, len(place)))


class _CoreSeconds:
    """Core-seconds of each file's tests, in this process and its descendants."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.used: Counter[str] = Counter()
        self.last = 0.0

    def pytest_collection_finish(self) -> None:
        self.last = self.used["start"] = _core_seconds()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(
        self, item: pytest.Item, nextitem: pytest.Item | None
    ) -> Generator[None, Any, Any]:
        done = yield
        if nextitem is None or nextitem.path != item.path:
            now = _core_seconds()
            self.used[item.path.relative_to(HERE).as_posix()] += now - self.last
            self.last = now
        return done

    def pytest_sessionfinish(self) -> None:
        if hasattr(self.config, "workeroutput"):  # a worker of pytest-xdist
            self.config.workeroutput["core_seconds"] = dict(self.used)

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any) -> None:
        self.used.update(getattr(node, "workeroutput", {}).get("core_seconds", {}))

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if not self.used:
            return
        budgets, packages = _budgets(), Counter[str]()
        for name, used in self.used.items():
            packages[name.partition("/")[0]] += used
        lines = [
            f"{name:>12} {used:6.0f} of {budgets.get(name, 0):4d}{'  over' * (used > budgets.get(name, 0))}"
            for name, used in sorted(packages.items())
        ]
        total = f"{'all':>12} {sum(packages.values()):6.0f} of {sum(budgets.values()):4d}"
        files = [
            f"{used:6.0f}  {name}{'  not in LONG' * (name not in LONG)}"
            for name, used in self.used.most_common()
            if used > 15.0 and name != "start"
        ]
        terminalreporter.section("core-seconds of files over 15")
        terminalreporter.write("\n".join([*files, ""]))
        terminalreporter.section("core-seconds of each package, of its budget in tests/README.md")
        terminalreporter.write("\n".join([*lines, total, ""]))


def _core_seconds() -> float:
    """Core-seconds of this process, its ended children and its living descendants."""
    ended = sum(
        used.ru_utime + used.ru_stime
        for used in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    )
    return ended + sum(_living(child) for child in psutil.Process(os.getpid()).children(recursive=True))


def _living(process: psutil.Process) -> float:
    try:
        times = process.cpu_times()
    except psutil.Error:
        return 0.0
    return times.user + times.system + times.children_user + times.children_system


def _budgets() -> dict[str, int]:
    text = (HERE / "README.md").read_text(encoding="utf-8")
    return {name: int(budget) for name, budget in re.findall(r"^\| `(\w+)` \| (\d+) \|", text, re.MULTILINE)}
