"""The card of a dataset: its facts, figures and page, and the files that are published."""
