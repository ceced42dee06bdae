"""The search for causes: fit, screen, confirm in the simulator, judge against noise."""
