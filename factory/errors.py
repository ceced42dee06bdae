"""Errors whose message is one sentence for the user."""

from __future__ import annotations


class InputError(Exception):
    """Bad input or an unusable target; its text is one sentence for the user (exit code 2)."""


def describe_os_error(error: OSError, doing: str) -> str:
    """One sentence on a failed file operation: the operation, the file and the system's reason."""
    where = f" {error.filename}" if error.filename else ""
    return f"{doing}{where}: {error.strerror or error}"


def one_line(error: BaseException, limit: int = 200) -> str:
    """Text of another library's error on one line; the name of its type if it has no text."""
    return (" ".join(str(error).split()) or type(error).__name__)[:limit]
