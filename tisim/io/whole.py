"""Files written in one piece: whole, or not at all."""

from __future__ import annotations

import contextlib
import re
import secrets
from collections.abc import Iterator
from pathlib import Path

_PART = re.compile(r"(\.[0-9a-f]{8})?\.part\Z")  # earlier versions had .part alone


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Path beside a file at which to write it, from where it is put in place in one step at the end.

    An error leaves the old file or none, and nothing beside it. A process that is killed may leave a part
    beside it (`whole_name`), under a name drawn for it, so that two processes never write into the same one.
    """
    part = path.with_name(f"{path.name}.{secrets.token_hex(4)}.part")
    try:
        yield part
        part.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):  # which would hide the error itself
            part.unlink()
        raise


def write_whole(path: Path, content: str | bytes) -> Path:
    """Write a file by `whole_file`; its folder is made.

    Parameters
    ----------
    path : Path
    content : str or bytes
        Text is written in UTF-8, lines as they are.

    Returns
    -------
    Path
        The argument.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as part, part.open("xb") as file:
        file.write(content.encode("utf-8") if isinstance(content, str) else content)
    return path


def whole_name(name: str) -> str:
    """Name of the file of which a process that was killed left a part; other names as they are."""
    return _PART.sub("", name)
