"""Files of testing machines: read as columns with quantities and units, whatever program wrote them.

    format, tests = read_lab_file("Ecoflex.csv")
    tests[0].with_quantity("force")

The format is found from the content. A further one is one file like `mach1.py`: a function that recognises
it, one that reads it, and `register(Importer(...))`; its import stands below, or the lab's own code makes it
(`TISIM_EXTENSIONS`).
"""

from calibration.lab_files import instron, mach1, table_with_header, trios, zwick
from calibration.lab_files._formats import Importer, importers, read_lab_file, register
from calibration.lab_files._quantities import DIMENSIONS, QUANTITIES, Quantity, plain, pulls
from calibration.lab_files._table import Column, LabTest, table
from calibration.lab_files._text import LabFile, Row, Sheet
from calibration.lab_files._units import Unit, name_and_unit, unit

__all__ = [
    "DIMENSIONS",
    "QUANTITIES",
    "Column",
    "Importer",
    "LabFile",
    "LabTest",
    "Quantity",
    "Row",
    "Sheet",
    "Unit",
    "importers",
    "instron",
    "mach1",
    "name_and_unit",
    "plain",
    "pulls",
    "read_lab_file",
    "register",
    "table",
    "table_with_header",
    "trios",
    "unit",
    "zwick",
]
