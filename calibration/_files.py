"""Names of files, and files written in one piece."""

from __future__ import annotations

import unicodedata

from tisim.io.whole import whole_name, write_whole


def on_any_disk(name: str) -> str:
    """The name without letter case and Unicode form: on some disks, names equal in this are one file."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


__all__ = ["on_any_disk", "whole_name", "write_whole"]
