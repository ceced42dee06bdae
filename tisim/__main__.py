"""`python -m tisim`: name, version and contents of the package."""

from __future__ import annotations

import argparse

import tisim


def main(arguments: list[str] | None = None) -> int:
    """Print a summary of the package; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tisim", description="What the simulator offers.")
    parser.add_argument("--version", action="version", version=f"tisim {tisim.__version__}")
    parser.parse_args(arguments)
    kinds = ", ".join(kind.name for kind in tisim.problems.kinds())
    print(f"tisim {tisim.__version__}: hyperelastic soft bodies, many at once. Used from Python:")
    print()
    print('    soft = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=300e3)')
    print("    result = tisim.simulate(tisim.Beam(material=soft, length=0.05))")
    print('    tisim.picture(result, "beam.png")')
    print()
    print(f"scenes      {kinds}")
    print(f"laws        {', '.join(tisim.laws.all_names())}")
    print(f"inclusions  {', '.join(tisim.inclusions.kinds())}")
    print("meshes      tisim.mesh: structured beams and blocks, bodies from STL and PLY surfaces")
    print("results     tisim.show: a page to turn around; tisim.fields: stress, strain, stretch;")
    print("            tisim.write: VTU, PVD, PLY, STL; tisim.picture: PNG")
    print()
    print("commands    python -m factory.build, python -m calibration.fit, python -m calibration.diagnose,")
    print("            python -m learn.train, python -m tisim.view (each with --help)")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
