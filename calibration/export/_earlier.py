"""Files of an earlier export, which a new one into the same folder replaces."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

from calibration.export import _registry
from calibration.export._readme import SIGNATURE

_LISTED = re.compile(r"- `([^`/\\]+)`: ")


def earlier_files(folder: Path) -> tuple[Path, ...]:
    """Files of the export in a folder, by its README.md, and results of its program; none without one.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    tuple of Path
        Of those, the files that exist; README.md is not among them.
    """
    try:
        lines = (folder / "README.md").read_text(encoding="utf-8").splitlines()
    except (FileNotFoundError, UnicodeDecodeError):
        return ()
    if SIGNATURE not in lines:
        return ()
    end = next((n for n, line in enumerate(lines) if line.startswith("## ")), len(lines))
    names = {found[1] for line in lines[:end] if (found := _LISTED.match(line))}
    for target in map(_registry.get, _registry.names()):
        if lines[0].endswith(f" for {target.title}"):
            names |= set(target.results)
    return tuple(p for p in sorted(folder / name for name in names - {"README.md", "..", "."}) if p.is_file())


def remove(files: Collection[Path], *, keep: Collection[Path]) -> None:
    """Remove files, but those of `keep`."""
    for path in set(files) - set(keep):
        path.unlink(missing_ok=True)
