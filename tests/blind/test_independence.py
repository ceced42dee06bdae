"""The laboratory shares no code with the packages under test, except to run the diagnosis."""

from __future__ import annotations

import ast
from pathlib import Path

import benchmarks.blind

LABORATORY = Path(benchmarks.blind.__file__).parent
OURS = {"tisim", "factory", "calibration", "learn"}


def test_only_the_caller_of_the_diagnosis_imports_what_is_under_test() -> None:
    importers = {}
    for file in LABORATORY.rglob("*.py"):
        names = set()
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                names.add(node.module.partition(".")[0])
        if names & OURS:
            importers[file.relative_to(LABORATORY).as_posix()] = sorted(names & OURS)
    assert importers == {"under_test.py": ["calibration"]}
