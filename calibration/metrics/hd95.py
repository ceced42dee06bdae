"""95th percentile Hausdorff distance."""

from __future__ import annotations

import numpy as np
import trimesh

from calibration.metrics._metric import Metric, check_body
from calibration.metrics.distances import SAMPLES_LOG2, SEED, both_ways


def hd95(
    simulated: trimesh.Trimesh,
    measured: trimesh.Trimesh,
    *,
    samples_log2: int = SAMPLES_LOG2,
    seed: int = SEED,
) -> float:
    """The larger of the two directed distances [m] that 95 % of a surface's area stays within.

    Points as for `surface_distance`. Some programs average the directions or pool them; on beams whose
    surfaces are alike that makes little difference.
    Raises InputError where a surface is not closed.
    Source: Huttenlocher, Klanderman and Rucklidge, IEEE Trans. PAMI 15 (1993) 850-863 (ranked Hausdorff
    distance); Taha and Hanbury, BMC Medical Imaging 15:29 (2015).
    """
    check_body(simulated, "simulated")
    check_body(measured, "measured")
    there, back = both_ways(simulated, measured, samples_log2=samples_log2, seed=seed)
    return float(max(np.percentile(there, 95), np.percentile(back, 95)))


METRIC = Metric(name="hd95", title="HD95", unit="m", higher_is_better=False, compute=hd95)
