"""Build and resume a dataset, with the screen of the command."""
