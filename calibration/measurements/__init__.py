"""One model a kind of measurement, for fits and diagnoses alike."""
