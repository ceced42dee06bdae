"""From a lab's own files to an experiment: `python -m calibration.new`."""

from calibration.new._command import EXAMPLES, app, main

__all__ = ["EXAMPLES", "app", "main"]
