"""How each effect acts in each kind of measurement."""
