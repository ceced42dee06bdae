"""The store: its arrays and files, the staged results it is assembled from, and its zip."""
