"""Files written in one piece: whole, or not at all."""

from __future__ import annotations

import contextlib
import re
import secrets
import unicodedata
from pathlib import Path

_PART = re.compile(r"(\.[0-9a-f]{8})?\.part\Z")  # earlier versions had .part alone


def write_whole(path: Path, content: str | bytes) -> Path:
    """Put a file in place in one step; its folder is made.

    An error leaves the old file or none, and nothing beside it. A process that is killed may leave a part
    beside it (`whole_name`), under a name drawn for it, so that two processes never write into the same one.

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
    part = path.with_name(f"{path.name}.{secrets.token_hex(4)}.part")
    try:
        with part.open("xb") as file:
            file.write(content.encode("utf-8") if isinstance(content, str) else content)
        part.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):  # which would hide the error itself
            part.unlink()
        raise
    return path


def on_any_disk(name: str) -> str:
    """The name without letter case and Unicode form: on some disks, names equal in this are one file."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


def whole_name(name: str) -> str:
    """Name of the file of which a process that was killed left a part; other names as they are."""
    return _PART.sub("", name)
