"""The paper's table of calibration results with our figures beside the printed ones."""

from calibration.table_of_paper.fits import fits_folder, read_fit
from calibration.table_of_paper.paper import Printed, printed
from calibration.table_of_paper.rows import Measures, Row, averages, measure, measured, row, traced_beams
from calibration.table_of_paper.write import rich_table, write_csv, write_markdown

__all__ = [
    "Measures",
    "Printed",
    "Row",
    "averages",
    "fits_folder",
    "measure",
    "measured",
    "printed",
    "read_fit",
    "rich_table",
    "row",
    "traced_beams",
    "write_csv",
    "write_markdown",
]
