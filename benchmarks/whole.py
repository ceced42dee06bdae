"""Files written in one piece. Own code: the laboratory of `benchmarks.blind` imports nothing under test."""

from __future__ import annotations

import contextlib
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import IO


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[IO[bytes]]:
    """A file beside `path`, put in its place at the end; after an error, the old file or none.

    Its name is drawn, so that two processes never write into the same one.
    """
    part = path.with_name(f"{path.name}.{secrets.token_hex(4)}.part")
    try:
        with part.open("xb") as file:
            yield file
        part.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):  # which would hide the error itself
            part.unlink()
        raise


def write_whole(path: Path, text: str) -> None:
    """Write a text by `whole_file`, in UTF-8."""
    with whole_file(path) as file:
        file.write(text.encode("utf-8"))
