"""Newton's method, for systems with a potential and for bodies in contact."""
