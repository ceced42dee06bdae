"""Numbers that the paper states of its datasets, for comparison."""

from __future__ import annotations

# "Generalizing Soft Tissue Deformation and Force Prediction Across Material Stiffness and Geometry"
SOURCE = "the paper's table of dataset features (label data_features, section Data Generation)"
# columns of that table: largest depth and force per poke, depth and force per snapshot
COLUMNS = ("Sim_max [mm]", "F_max [N]", "Tip_mean [mm]", "F_mean [N]")
# law -> material level -> mean and sd of each column
PAPER: dict[str, dict[str, tuple[tuple[float, float], ...]]] = {
    "mooney-rivlin": {
        "S0": ((13.92, 3.88), (12.92, 5.32), (7.91, 4.82), (4.80, 4.59)),
        "S0.5": ((13.78, 4.14), (6.19, 2.69), (7.94, 4.89), (2.33, 2.30)),
        "S1": ((13.46, 4.24), (3.87, 2.43), (7.82, 4.87), (1.42, 1.54)),
    },
    "ogden": {
        "S0": ((16.32, 6.53), (29.71, 25.31), (9.88, 6.54), (6.94, 11.44)),
        "S0.5": ((16.40, 6.41), (18.35, 18.67), (9.89, 6.54), (3.94, 7.47)),
        "S1": ((11.20, 4.82), (2.34, 1.98), (7.04, 4.87), (1.01, 1.19)),
    },
}

# text of section Data Generation: 11 x 3 x 40 pokes of each law, and the total of their snapshots
SHAPES, POKES_EACH = 11, 40
SNAPSHOTS = {"ogden": 14305, "mooney-rivlin": 13672}
DEPTH_MM = 30.0  # the largest requested depth


def pokes_a_level() -> int:
    """Number of pokes in each row of the paper's table: all shapes at one material level."""
    return SHAPES * POKES_EACH
