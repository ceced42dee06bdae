"""Models of measurements, one per kind of measurement, for fits and diagnoses."""
