from ._show import show, view_of_file
from ._view import Curve, Field, Surface, View, outlines

__all__ = ["Curve", "Field", "Surface", "View", "outlines", "show", "view_of_file"]
