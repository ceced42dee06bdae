"""What the tests of the evaluation share: the trained model's name, a poke, and its colours in pictures."""

MODEL = (
    "invariant-gnn-small"  # of `tests.learn.commands.RECIPE`; no statement here is about a certain network
)
POKE = "site_mm: [5, -10]\ndepth_mm: 2\nangle_deg: 20\nheading_deg: 45\nshape: shape-1\nsoftness: S1\n"
BLUE, ORANGE, INDENTER, RIGID_GREY = "#1f77b4", "#ff7f0e", "#d62728", "#bfbfbf"
