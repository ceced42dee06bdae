"""Names out of files as matplotlib can draw them."""

from __future__ import annotations

from functools import cache

from matplotlib.font_manager import FontProperties, findfont, get_font

LONGEST = 44
LINE = 54  # where a label may go on in a second line


def label(text: str, longest: int = LONGEST) -> str:
    """Text that is drawn as it stands: no mathematics between dollars, one line, shortened in its middle,
    characters that the font lacks as a box drawn by it."""
    known = _drawable()
    shown = "".join(c if ord(c) in known else "\N{WHITE SQUARE}" for c in " ".join(text.split()))
    if len(shown) > longest:
        head = (longest - 1) * 2 // 3
        shown = shown[:head] + "…" + shown[head + 1 - longest :]
    return shown.replace("$", r"\$")


def label_of_causes(text: str, longest: int = LINE) -> str:
    """The same of several causes, "a + b + c": as many on a line as there is room for."""
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
