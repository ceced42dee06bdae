from . import export

__all__ = ["export"]
