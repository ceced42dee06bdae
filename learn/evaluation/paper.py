"""The paper's results table (arXiv 2509.10125's successor, "GNN prediction results"), to stand beside ours.

Its data reach about 14 to 16 mm of depth on 1,320 pokes; its tip error is not defined there.
"""

from __future__ import annotations

from learn.evaluation.summary import Value

# law, softness: force [N], mean [mm], max [mm], tip [share]; mean and sd
_ROWS = {
    ("mooney-rivlin", "S0"): ((0.537, 1.001), (0.097, 0.152), (1.205, 0.854), (0.023, 0.025)),
    ("mooney-rivlin", "S0.5"): ((0.310, 0.540), (0.097, 0.155), (1.228, 0.924), (0.021, 0.023)),
    ("mooney-rivlin", "S1"): ((0.258, 0.650), (0.092, 0.157), (1.268, 0.944), (0.022, 0.026)),
    ("mooney-rivlin", "all"): ((0.337, 0.708), (0.095, 0.155), (1.239, 0.918), (0.022, 0.024)),
    ("ogden", "S0"): ((2.269, 6.358), (0.127, 0.209), (1.496, 1.084), (0.025, 0.026)),
    ("ogden", "S0.5"): ((1.407, 5.155), (0.132, 0.219), (1.517, 1.104), (0.024, 0.025)),
    ("ogden", "S1"): ((0.222, 0.776), (0.079, 0.145), (1.237, 1.013), (0.021, 0.027)),
    ("ogden", "all"): ((1.253, 4.751), (0.114, 0.198), (1.427, 1.080), (0.023, 0.026)),
}
PAPER = {
    key: dict(zip(("force", "mean", "max", "tip"), (Value(*pair) for pair in row), strict=True))
    for key, row in _ROWS.items()
}
