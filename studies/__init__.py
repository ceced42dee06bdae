"""Dated records of measurements on our own methods, and the scripts that make their tables and pictures.

Run from the repository's folder, `python -m studies.corrections` and so on. Records of real data need the
folder that holds `real/`, by the environment's TISIM_MEASURED.
"""
