"""Models of the effects in each kind of measurement."""
