"""
Diagnosis of a homogeneous test
===============================

The shipped specimens were stretched by a machine with compliance. A fit gives moduli that are too low;
the diagnosis names the machine's compliance.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import calibration

root = next(p for p in (Path.cwd(), *Path.cwd().parents) if (p / "datasets" / "measured").exists())
diagnosis = calibration.diagnose(calibration.read_experiment(root / "datasets" / "measured" / "coupons"))
print(diagnosis.sentence)

# %%
# Chi-square per degree of freedom of the baseline, and of the model with the cause:
folder = Path(tempfile.mkdtemp())
diagnosis.write(folder)  # report.html, diagnosis.json, cards
file = calibration.read_diagnosis(folder / "diagnosis.json")
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.barh(
    ["baseline", "with the cause"], [file.baseline.reduced_chi2, file.extended.reduced_chi2], color="#1f5fa8"
)
axes.set(xscale="log", xlabel="chi-square per degree of freedom")
axes.axvline(1.0, color="0.5", linewidth=0.8)
