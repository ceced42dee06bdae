"""How large the finder sees what is hidden, beside the blind count, where the photographs have no noise.

    python tests/blind/noise_free.py --only 1,4,8,40     # some 10 core-s a case
    python tests/blind/noise_free.py --rivals --only 82  # how near the rivals of its effect are, 60 core-s

Contour and registration noise are left out of the photographs, but not out of the finder's expectations: what
is printed is the effect itself and how the two solvers differ, in the finder's standard deviations.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import _blind_lab as lab
import numpy as np
from _blind_limit import least_fits, told
from _blind_store import load_case, load_truth

from calibration.diagnosis.beams import BeamModel
from calibration.diagnosis.screening import screen
from calibration.diagnosis.search import calibrated
from calibration.experiment import read


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=Path, default=Path(__file__).parent / "beams")
    parser.add_argument("--only", required=True, help="indices of cases, by commas")
    parser.add_argument("--rivals", action="store_true", help="fit what comes near, as limit_records.py does")
    given = parser.parse_args()
    lab._noisy = lab._registered = lambda edges, _: edges
    truth = load_truth(given.cases)["cases"]
    for index in map(int, given.only.split(",")):
        with tempfile.TemporaryDirectory() as place:
            lab.write_experiment(*load_case(given.cases, index), Path(place) / "experiment")
            model = BeamModel(read(Path(place) / "experiment"), workers=1)
        if given.rivals:
            effect = truth[f"{index:03d}"]["hidden"][0]["effect"]
            print(f"{index:03d} {effect} {told(least_fits(model, effect), effect)[0]}", flush=True)
            continue
        baseline = calibrated(model)
        linear = model.linearise(baseline.state, model.candidates)
        screened = screen(linear, model.effects)
        sigmas = np.sqrt(screened.gains(linear.z))
        best = int(np.argmax(screened.promises(linear.z)))
        print(
            f"{index:03d} chi-square {baseline.chi2:.1f}; most: {screened.candidates[best].label}"
            f" {sigmas[best]:.1f}",
            flush=True,
        )
        for hidden in truth[f"{index:03d}"]["hidden"]:
            seen = [
                k
                for k, c in enumerate(screened.candidates)
                if c.effect == hidden["effect"] and hidden["scope"] in (c.at, "bridges")
            ]
            if seen:
                most = max(float(sigmas[k]) for k in seen)
                blind = truth[f"{index:03d}"]["sigma"][hidden["effect"]]
                print(f"    {hidden['effect']} of {hidden['scope']}: {most:.1f} sigmas, blind count {blind}")


if __name__ == "__main__":
    main()
