"""The parts of `docs/corrections_study.py`."""
