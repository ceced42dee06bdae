"""Makes docs/pictures/poke.png, the picture in the README:  python -m studies.pictures.poke  (a minute)."""

import argparse
from pathlib import Path

import numpy as np

import tisim

PICTURE = Path(__file__).resolve().parents[2] / "docs" / "pictures" / "poke.png"


def main() -> None:
    """A rod 9 mm deep, 25 degrees off the normal, in Ogden silicone beside a rigid cube."""
    angle = np.radians(25.0)
    poke = tisim.Poke(
        material=tisim.material_from_moduli("ogden", shear_modulus=30e3, bulk_modulus=600e3),
        block=tisim.Block(
            inclusion=tisim.BoxInclusion(size=(0.016, 0.016, 0.016), centre=(0.016, 0.006, 0.008), angle=0.4)
        ),
        direction=(float(np.sin(angle)), 0.0, -float(np.cos(angle))),
        depth=0.009,
    )
    (result,) = tisim.simulate([poke])
    PICTURE.parent.mkdir(exist_ok=True)
    tisim.picture(result, PICTURE)
    print(f"{PICTURE}: {result.status}, {result.cost.core_seconds:.0f} core-s")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    main()
