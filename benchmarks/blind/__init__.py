"""The blind laboratory: made experiments with a hidden cause, diagnosed without their truth, and scored.

    python -m benchmarks.blind.beams.run --out DIR         # 200 stored cases of photographed beams
    python -m benchmarks.blind.coupons.run                 # homogeneous material tests
    python -m benchmarks.blind.indentation.run             # indentation
    python -m benchmarks.blind.compression.run             # compression between platens
    python -m benchmarks.blind.controls KIND               # controls: a cause taken out, and others
    python -m benchmarks.blind.make_examples               # the examples in datasets/measured

The laboratory shares no code with the packages under test, only the format of an experiment
(docs/reference/experiment-format.md): its own solvers, laws, noise and causes. `under_test` is the one
module that calls the diagnosis. `python -m pytest tests/blind` tests the laboratory itself.
"""
