"""The blind laboratory: synthetic experiments with a hidden cause, diagnosed without access to the truth.

    python -m benchmarks.blind.beams.run --out DIR         # 200 stored cases of photographed beams
    python -m benchmarks.blind.coupons.run                 # homogeneous material tests
    python -m benchmarks.blind.indentation.run             # indentation
    python -m benchmarks.blind.compression.run             # compression between platens
    python -m benchmarks.blind.controls KIND               # controls, such as the true cause removed
    python -m benchmarks.blind.make_examples               # the examples in datasets/measured

The diagnoses are scored against the truth. The laboratory shares no code with the packages under test, only
the format of an experiment (docs/reference/experiment-format.md): solvers, constitutive laws, noise and
causes are its own. `under_test` is the one module that calls the diagnosis. `python -m pytest tests/blind`
tests the laboratory itself.
"""
