"""Other programs on the same problems: CalculiX and FElupe."""
