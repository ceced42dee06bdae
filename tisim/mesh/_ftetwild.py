"""fTetWild in a separate process (run as a script: input.npz output.npz).

It leaves a file in the current directory, cannot be stopped from Python, and may crash the process if it
fails.
"""

import sys

import numpy as np
import pytetwild


def main(source: str, target: str) -> None:
    """Mesh the surface in `source` and write vertices (n, 3) and tetrahedra (m, 4) to `target`."""
    with np.load(source) as data:
        vertices, tetrahedra = pytetwild.tetrahedralize(
            data["vertices"],
            data["faces"],
            edge_length_abs=float(data["edge_length"]),
            epsilon=float(data["epsilon"]),
            stop_energy=float(data["stop_energy"]),
            # a second thread saves no time (measured)
            num_threads=1,
            quiet=True,
        )
    np.savez(target, vertices=vertices, tetrahedra=tetrahedra)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
