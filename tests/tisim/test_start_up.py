"""Loading at the first solve: MKL without a search of the disk, compiled kernels and their error messages."""

import os
import subprocess
import sys
import time
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

from tisim.kernels._taichi import ensure_runtime, ti
from tisim.linear.direct import HAVE_PARDISO
from tisim.linear.pardiso import _file_of_mkl

ROOT = Path(__file__).parents[2]


@pytest.mark.skipif(not HAVE_PARDISO, reason="pypardiso is for x86-64")
def test_mkl_is_found_where_its_package_says(monkeypatch):
    monkeypatch.delenv("PYPARDISO_MKL_RT", raising=False)
    found = _file_of_mkl()
    assert found is not None
    assert Path(found).is_file()
    assert "mkl_rt" in Path(found).name


def test_a_library_that_the_user_names_is_left_to_pypardiso(monkeypatch):
    monkeypatch.setenv("PYPARDISO_MKL_RT", "somewhere")
    assert _file_of_mkl() is None


def test_without_the_package_the_search_is_left_to_pypardiso(monkeypatch):
    def absent(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.delenv("PYPARDISO_MKL_RT", raising=False)
    monkeypatch.setattr(metadata, "files", absent)
    assert _file_of_mkl() is None
    monkeypatch.setattr(metadata, "files", lambda _: [])
    assert _file_of_mkl() is None


COMPILE = """
import numpy as np
from tisim.kernels._taichi import ensure_runtime, ti
ensure_runtime()

@ti.kernel
def count(values: ti.types.ndarray(dtype=ti.f64, ndim=1)):
    for i in range(3):
        values[i] = values[i] + 1.0

count(np.zeros(3))
"""


@pytest.mark.parametrize(("age", "kept"), [(3600.0, False), (0.0, True)])
def test_a_lock_that_a_killed_process_left_does_not_keep_kernels_from_the_disk(tmp_path, age, kept):
    """A lock that is an hour old is removed; one that was just created is kept, and nothing is cached."""
    lock = tmp_path / "ticache.lock"
    lock.touch()
    os.utime(lock, (time.time() - age,) * 2)
    script = tmp_path / "compile.py"
    script.write_text(COMPILE)
    environment = {**os.environ, "TI_OFFLINE_CACHE_FILE_PATH": str(tmp_path), "PYTHONPATH": str(ROOT)}
    subprocess.run([sys.executable, script], env=environment, check=True, capture_output=True)
    assert lock.exists() == kept
    assert bool(list(tmp_path.glob("*.tic"))) != kept


def test_errors_of_kernels_show_their_line():
    ensure_runtime()

    @ti.kernel
    def wrong(values: ti.types.ndarray(dtype=ti.f64, ndim=1)):
        for i in range(3):
            values[i] = name_that_nobody_defined + 1.0  # noqa: F821

    with pytest.raises(ti.TaichiCompilationError, match=r"name_that_nobody_defined \+ 1.0") as caught:
        wrong(np.zeros(3))
    assert "^^^^" in str(caught.value)


def test_later_calls_of_a_kernel_take_what_the_first_one_took():
    """Calls with arguments of the same types take the fast path, all others are checked as Taichi does."""
    ensure_runtime()

    @ti.kernel
    def scale(values: ti.types.ndarray(dtype=ti.f64, ndim=2), by: ti.f64, times: ti.i32):
        ti.loop_config(serialize=True)
        for i in range(values.shape[0]):
            for k in range(values.shape[1]):
                values[i, k] = values[i, k] * by + times

    grid = np.arange(6.0).reshape(2, 3)
    for given in (grid.copy(), grid.copy(), grid[:1].copy(), np.asfortranarray(grid), grid.copy()):
        wanted = given * 2.0 + 3
        scale(given, np.float64(2.0), np.int64(3))
        np.testing.assert_array_equal(given, wanted)
        scale(given, 1, 3)
        np.testing.assert_array_equal(given, wanted + 3)
    with pytest.raises(ValueError, match="required array has dtype=f64"):
        scale(grid.astype(np.float32), 2.0, 3)
    with pytest.raises(ValueError, match="required array has ndim=2"):
        scale(grid.ravel(), 2.0, 3)
    with pytest.raises(ValueError, match="Non contiguous"):
        scale(np.zeros((4, 4))[::2, ::2], 2.0, 3)
    with pytest.raises(ti.TaichiRuntimeTypeError, match="cannot be converted"):
        scale(grid, "2.0", 3)
    with pytest.raises(ti.TaichiRuntimeTypeError, match="cannot be converted"):
        scale(grid, 2.0, 3.5)
