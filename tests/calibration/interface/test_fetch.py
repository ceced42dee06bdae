"""Public measurements: downloaded from a (local) server, checked, written as an experiment."""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

pytest.importorskip("pooch")

from calibration import fetch as fetching
from calibration import read_experiment
from calibration.errors import InputError
from calibration.fetch import Source, fetch

HEAD = """EF30_0T_A_sample_1
Compression test;
Time (s),Compression (mm),Load (N),Engineering Strain [-],Engineering Stress (kPa),True Strain [-]
"""
LICENCE = "Creative Commons Attribution 4.0 (made for this test)\n"


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def served(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[str, Path]]:
    """URL and folder of a server of synthetic files, whose checksums replace the source's."""
    root = tmp_path / "server"
    (source,) = [s for s in fetching.sources() if s.name == "ecoflex-cylinders"]
    sums = {}
    for n, path in enumerate(source.files):
        rows = "".join(f"{0.1 * k},0,0,{-0.01 * k},{-(n + 1.0) * k},0\n" for k in range(5))
        text = HEAD + rows if path.endswith(".csv") else LICENCE
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text, encoding="utf-8")
        sums[path] = hashlib.sha256(text.encode()).hexdigest()
    monkeypatch.setitem(fetching._SOURCES, source.name, replace(source, files=sums))
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(root)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_address[1]}", root
    server.shutdown()
    server.server_close()


def test_what_is_fetched_is_an_experiment_with_its_licence(served: tuple[str, Path], tmp_path: Path) -> None:
    folder = fetch("ecoflex-cylinders", tmp_path / "got", base=served[0])
    data = read_experiment(folder)
    assert len(data.trials) == 7
    assert set(data.materials) == {"EF10", "EF30", "EF50"}
    assert data.trials[0].stretch.tolist() == pytest.approx([1.0, 0.99, 0.98, 0.97, 0.96])  # type: ignore[union-attr]
    assert LICENCE in (folder / "SOURCE.md").read_text(encoding="utf-8")


def test_a_file_that_is_not_what_it_was_is_refused(served: tuple[str, Path], tmp_path: Path) -> None:
    base, root = served
    (root / "data/EF30_0T/EF30_0T_A2.csv").write_text(HEAD + "0,0,0,0,0,0\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"EF30_0T_A2\.csv: expected the file as it was published"):
        fetch("ecoflex-cylinders", tmp_path / "got", base=base)


def test_what_cannot_be_had_is_one_sentence(served: tuple[str, Path], tmp_path: Path) -> None:
    base, root = served
    (root / "CITATION.cff").rename(root / "away")
    with pytest.raises(InputError, match=r"CITATION\.cff: cannot be had"):
        fetch("ecoflex-cylinders", tmp_path / "got", base=base)
    (root / "away").rename(root / "CITATION.cff")
    assert (fetch("ecoflex-cylinders", tmp_path / "got", base=base) / "SOURCE.md").is_file()  # goes on
    with pytest.raises(InputError, match="expected an empty folder"):
        fetch("ecoflex-cylinders", tmp_path / "got", base=base)
    with pytest.raises(InputError, match="expected one of ecoflex-cylinders"):
        fetch("moon-dust", tmp_path / "other")


def test_a_source_has_its_licence_and_checksums() -> None:
    for source in fetching.sources():
        assert isinstance(source, Source)
        assert source.licence_file in source.files
        assert all(len(digest) == 64 for digest in source.files.values())
        assert source.base.startswith("https://")
    with pytest.raises(ValueError, match="registered already"):
        fetching.register(fetching.sources()[0])
