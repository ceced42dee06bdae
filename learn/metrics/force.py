"""Errors of the force's size."""

import numpy as np

from learn.metrics._cases import Cases, Floats, metric


@metric("force", units="N", text="|predicted - true| of the size of the rod's force, the paper's")
def force_error(cases: Cases) -> Floats:
    """One value a frame [N]."""
    return np.abs(cases.force_predicted - cases.force)


@metric("force share", units="%", percent=True, digits=1, text="the same relative to the true force")
def force_share(cases: Cases) -> Floats:
    """One value a frame, as a share."""
    return np.asarray(np.abs(cases.force_predicted - cases.force) / cases.force)
