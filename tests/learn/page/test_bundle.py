"""The committed bundle is built from the committed sources and includes its licences."""

from __future__ import annotations

import hashlib
import json
import lzma
from pathlib import Path

PAGE = Path(__file__).parents[3] / "learn" / "page"
BUNDLE, SOURCES = PAGE / "bundle", PAGE / "js"
RECORD = json.loads((BUNDLE / "bundle.json").read_text())


def _sums(folder: Path, names: list[str]) -> dict[str, str]:
    return {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in sorted(names)}


def test_bundle_and_sources_agree() -> None:
    """If this fails, build the bundle again: cd learn/page/js && npm ci && npm run build."""
    sources = [path.name for path in SOURCES.iterdir() if path.suffix in (".js", ".mjs", ".json")]
    made = [path.name for path in BUNDLE.iterdir() if path.name != "bundle.json"]
    assert RECORD["sources"] == _sums(SOURCES, sources)
    assert RECORD["made"] == _sums(BUNDLE, made)


def test_versions_are_pinned_and_no_registry_is_named() -> None:
    package = json.loads((SOURCES / "package.json").read_text())
    lock = json.loads((SOURCES / "package-lock.json").read_text())
    pinned = {**package["dependencies"], **package["devDependencies"]}
    for name, version in pinned.items():
        assert lock["packages"][f"node_modules/{name}"]["version"] == version
    assert RECORD["versions"] == package["dependencies"]
    assert not [name for name, entry in lock["packages"].items() if "resolved" in entry]


def test_licences_are_beside_it() -> None:
    for name, holder in (("three", "three.js authors"), ("onnxruntime", "Microsoft")):
        text = (BUNDLE / f"LICENSE-{name}.txt").read_text(encoding="utf-8")
        assert holder in text
        assert "Permission is hereby granted, free of charge" in text
    assert b"Eigen" in lzma.decompress((BUNDLE / "NOTICES-onnxruntime.txt.xz").read_bytes())


def test_it_takes_no_origin_for_the_base_of_a_url() -> None:
    """The origin of a page opened from disk is "null" in Firefox, where the page did not start."""
    assert "location.origin" not in (BUNDLE / "page.js").read_text(encoding="utf-8")


def test_it_is_small_and_needs_no_network() -> None:
    assert sum(path.stat().st_size for path in BUNDLE.iterdir()) < 4e6
    assert lzma.decompress((BUNDLE / "onnxruntime.wasm.xz").read_bytes())[:4] == b"\0asm"
    assert "</script" not in (BUNDLE / "page.js").read_text(encoding="utf-8").lower()
