"""Errors of one sentence, for people."""

from __future__ import annotations


class InputError(Exception):
    """Bad input or an unusable target; its text is one sentence for people (exit code 2)."""


def describe_os_error(error: OSError, doing: str) -> str:
    """One sentence for a failed file operation: what was being done, where, and the system's reason."""
    where = f" {error.filename}" if error.filename else ""
    return f"{doing}{where}: {error.strerror or error}"


def one_line(error: BaseException, limit: int = 200) -> str:
    """The text of an error of another library on one line; its type where it has no text."""
    return (" ".join(str(error).split()) or type(error).__name__)[:limit]
