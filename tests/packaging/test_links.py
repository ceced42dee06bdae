"""Links between pages have targets, and the commands and files that pages name exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.packaging.blocks import ROOT

PAGES = sorted(
    p.relative_to(ROOT).as_posix()
    for folder in (".", "docs", "studies", "benchmarks", "datasets/measured", "datasets/cards")
    for p in (ROOT / folder).glob("*.md" if folder == "." else "**/*.md")
    if not {"_build", "gallery"} & set(p.relative_to(ROOT).parts[:2])
)
_LINK = re.compile(r"\[[^\]\n]*\]\(([^)\s]+)\)")
_FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
_PAGE = re.compile(r"\b(?:docs|studies)/(?!_build)[A-Za-z0-9_/.-]*[A-Za-z0-9_]")
_MODULE = re.compile(r"\bpython -m ((?:factory|calibration|learn|benchmarks|studies)[\w.]*)")


def anchors(text: str) -> set[str]:
    """Anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", _FENCED.sub("", text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", h.lower()).strip().replace(" ", "-") for h in headings}


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_to_files_of_the_repository(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    for link in _LINK.findall(_FENCED.sub("", text)):
        if re.match(r"[a-z]+:", link):
            continue
        target, _, anchor = link.partition("#")
        path = (ROOT / page).parent / target if target else ROOT / page
        assert path.exists(), f"{page}: {link}"
        if anchor:
            assert anchor in anchors(path.read_text(encoding="utf-8")), f"{page}: {link}"


@pytest.mark.parametrize("page", PAGES)
def test_commands_name_modules_that_exist(page: str) -> None:
    for name in _MODULE.findall((ROOT / page).read_text(encoding="utf-8")):
        module = ROOT.joinpath(*name.rstrip(".").split("."))
        runs = (module.with_suffix(".py"), module / "__main__.py")
        assert any(p.exists() for p in runs), f"{page}: python -m {name}"


def test_pages_that_code_refers_to_exist() -> None:
    missing = []
    for path in sorted(ROOT.glob("*/**/*.py")):
        if {"build", "_build", ".venv"} & set(path.relative_to(ROOT).parts):
            continue
        for name in _PAGE.findall(path.read_text(encoding="utf-8")):
            page = ROOT / name
            if not any(page.with_name(page.name + end).exists() for end in ("", ".py", ".md")):
                missing.append(f"{path.relative_to(ROOT)}: {name}")
    assert not missing


@pytest.mark.parametrize("folder", ["tutorials", "how-to", "explanation", "reference"])
def test_every_page_of_the_manual_is_in_its_index(folder: str) -> None:
    index = (ROOT / "docs" / folder / "index.md").read_text(encoding="utf-8")
    linked = {link.partition("#")[0] for link in _LINK.findall(index)}
    pages = {p.name for p in (ROOT / "docs" / folder).glob("*.md")} - {"index.md", "commands-help.md"}
    assert pages <= linked


def test_pages_name_no_place_outside_the_repository() -> None:
    for page in PAGES:
        text = (ROOT / page).read_text(encoding="utf-8")
        assert not re.search(
            r"(?<![\w/])(\.\./shared|/home/|/root/)|(?<![\w/$.-])measured/(bench|real)", text
        ), page


def test_anchor_of_a_heading() -> None:
    assert anchors("# A bar, let go\n```\n# no heading\n```\n## `kind: beam`\n") == {
        "a-bar-let-go",
        "kind-beam",
    }
    assert Path(ROOT, "README.md").exists()
