"""`python -m calibration.new`: from a lab's own files to an experiment."""

from calibration.new._command import EXAMPLES, app, main

__all__ = ["EXAMPLES", "app", "main"]
