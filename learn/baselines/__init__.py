"""What a model has to beat, one a file."""

from learn.baselines._baseline import Baseline
from learn.baselines.kernel import Kernel
from learn.baselines.modes import Modes
from learn.baselines.nearest import Nearest
from learn.baselines.zero import Zero

BASELINES: dict[str, type[Baseline]] = {
    "zero displacement": Zero,
    "nearest training poke": Nearest,
    "PCA and MLP": Modes,
    "analytic kernel": Kernel,
}

__all__ = ["BASELINES", "Baseline"]
