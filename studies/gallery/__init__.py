"""Real measurements, diagnosed: one table."""
