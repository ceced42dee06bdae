"""The search for causes: fit the baseline, screen candidates, confirm in the simulator, test for noise."""
