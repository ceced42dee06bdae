"""References: solutions by independent solvers, each computed once into a JSON file beside its script."""
