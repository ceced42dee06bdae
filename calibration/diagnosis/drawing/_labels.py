"""Names from files as labels for matplotlib."""

from __future__ import annotations

from functools import cache

from matplotlib.font_manager import FontProperties, findfont, get_font

LONGEST = 44  # largest number of characters of a label
LINE = 54  # number of characters after which a label of several causes continues on a new line


def label(text: str, longest: int = LONGEST) -> str:
    """Text that matplotlib draws literally, in one line.

    Dollar signs are escaped, characters that the font lacks are replaced by a white square, and text over
    `longest` characters is shortened in its middle.
    """
    known = _drawable()
    shown = "".join(c if ord(c) in known else "\N{WHITE SQUARE}" for c in " ".join(text.split()))
    if len(shown) > longest:
        head = (longest - 1) * 2 // 3
        shown = shown[:head] + "…" + shown[head + 1 - longest :]
    return shown.replace("$", r"\$")


def label_of_causes(text: str, longest: int = LINE) -> str:
    """Label of several causes, "a + b + c", broken into lines of about `longest` characters."""
    lines: list[str] = []
    for part in text.split(" + "):
        if lines and len(lines[-1]) + len(" + ") + len(part) <= longest:
            lines[-1] += f" + {part}"
        else:
            lines.append(part)
    return " +\n".join(label(line, longest) for line in lines)


@cache
def _drawable() -> frozenset[int]:
    return frozenset(get_font(findfont(FontProperties())).get_charmap())
