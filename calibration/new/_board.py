"""The checkerboard to photograph, as a PDF page in true size, written without any library.

How it is used: docs/how-to/photograph.md. Around the squares stays white paper of at least one square.
"""

from __future__ import annotations

import math

from calibration.errors import InputError
from calibration.new._answers import BoardAnswers

_POINTS = 72.0 / 25.4  # of a millimetre
_PAGES = {"a4": (297.0, 210.0), "a3": (420.0, 297.0), "letter": (279.4, 215.9)}  # mm, lying
_EDGE = 8.0  # mm that printers leave white
_RULER = 100.0  # mm
_BELOW, _LEAST_BELOW = 16.0, 5.0  # mm, of the ruler and its text, and of the paper between it and the squares


def board_pdf(board: BoardAnswers, key: str = "board.square_mm") -> bytes:
    """One page with the board, a ruler of 100 mm to check the print, and how to print it.

    Parameters
    ----------
    board : BoardAnswers
    key : str
        Where the side of a square stands, for the sentence on one that is too large.

    Raises
    ------
    InputError
        The board does not fit on the page.
    """
    columns, rows = board.squares
    side = board.square_mm
    page = _PAGES[board.page]
    width, height = columns * side, rows * side
    largest = _largest(columns, rows, page)
    if side > largest:
        raise InputError(
            f"{key}: a board of {columns} x {rows} squares of {side:g} mm does not fit on"
            f" {board.page}: expected at most {math.floor(10 * largest) / 10:g} mm"
        )
    below = max(side, _LEAST_BELOW) + _BELOW
    room = page[1] - 2 * _EDGE - side - below
    left, bottom = 0.5 * (page[0] - width), _EDGE + below + 0.5 * (room - height)
    parts = ["0 g"]
    for column in range(columns):
        for row in range(rows):
            if (column + row) % 2 == 0:
                parts.append(_box(left + column * side, bottom + row * side, side, side))
    start, line = 0.5 * (page[0] - _RULER), _EDGE + 7.0
    parts.append(_box(start, line, _RULER, 0.2))
    for tick in range(11):
        parts.append(_box(start + 10 * tick - 0.1, line, 0.2, 3.0 if tick % 5 else 5.0))
    text = (
        f"{columns} x {rows} squares of {side:g} mm. Print at 100 %, not fitted to the page: this ruler is"
        " 100 mm long. Glue it on a flat plate."
    )
    parts.append(f"BT /F1 9 Tf {2 * _EDGE * _POINTS:.3f} {_EDGE * _POINTS:.3f} Td ({text}) Tj ET")
    return _document("\n".join(parts), page)


def _largest(columns: int, rows: int, page: tuple[float, float]) -> float:
    """Side of the largest squares [mm]: white paper of one square is beside them, above, and below."""
    across, up = page[0] - 2 * _EDGE, page[1] - 2 * _EDGE - _BELOW
    side = up / (rows + 2)
    if side < _LEAST_BELOW:
        side = (up - _LEAST_BELOW) / (rows + 1)
    return min(side, across / (columns + 2))


def _box(x: float, y: float, width: float, height: float) -> str:
    return " ".join(f"{v * _POINTS:.4f}" for v in (x, y, width, height)) + " re f"


def _document(content: str, page: tuple[float, float]) -> bytes:
    """A PDF 1.4 file of one page."""
    stream = content.encode("ascii")
    box = f"0 0 {page[0] * _POINTS:.3f} {page[1] * _POINTS:.3f}"
    objects = [
        b"<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
        b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [{box}] /Contents 4 0 R"
        " /Resources << /Font << /F1 5 0 R >> >> >>".encode(),
        b"<< /Length %d >>\nstream\n%b\nendstream" % (len(stream), stream),
        b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
    ]
    out = bytearray(b"%PDF-1.4\n")
    places = []
    for number, body in enumerate(objects, 1):
        places.append(len(out))
        out += b"%d 0 obj\n%b\nendobj\n" % (number, body)
    table = len(out)
    out += b"xref\n0 %d\n0000000000 65535 f \n" % (len(objects) + 1)
    for place in places:
        out += b"%010d 00000 n \n" % place
    out += b"trailer\n<< /Size %d /Root 1 0 R >>\nstartxref\n%d\n%%%%EOF\n" % (len(objects) + 1, table)
    return bytes(out)
