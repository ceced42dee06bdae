from .metrics import register_metric
from .models import register_model
from .predictor import PokePrediction, Predictor, load

__version__: str

__all__ = ["PokePrediction", "Predictor", "load", "register_metric", "register_model"]
