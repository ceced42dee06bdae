"""Newton's method, on anything with a potential and on bodies in contact."""
