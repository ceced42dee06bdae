"""What a simulation gets wrong, and why: effects nested in the simulator, searched for, named or not named.

>>> from pathlib import Path
>>> from calibration.diagnosis import diagnose, model_of
>>> from calibration.experiment import read
>>> model = model_of(read(Path("measured/bench/creeps")))  # doctest: +SKIP
>>> diagnose(model).sentence()  # doctest: +SKIP
'Found: the material creeps: it sinks further with time (creep).'
"""

from calibration.diagnosis.beams.simulators import SIMULATORS
from calibration.diagnosis.domains import KINDS, model_of
from calibration.diagnosis.effect import Candidate, Effect
from calibration.diagnosis.run import Diagnosable, diagnose
from calibration.diagnosis.search import Finding, Rules, search
from calibration.diagnosis.verdict import Diagnosis

__all__ = [
    "KINDS",
    "SIMULATORS",
    "Candidate",
    "Diagnosable",
    "Diagnosis",
    "Effect",
    "Finding",
    "Rules",
    "diagnose",
    "model_of",
    "search",
]
