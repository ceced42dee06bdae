"""Effects of the specimen: deviations from the stated geometry, manufacture and surface."""

from __future__ import annotations

from calibration.measurements._effect import Effect

RADIUS = Effect(
    name="radius",
    parameter="excess_mm",
    per_unit=1e3,
    belongs_to="specimen",
    sentence="the section is thicker or thinner than stated",
    remedy="measure the section with callipers",
)

SECTION_SCALE = Effect(
    name="section-scale",
    parameter="excess",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the section is larger or smaller than stated, in all directions by one factor",
    remedy="measure the section with callipers",
)

TAPER = Effect(
    name="taper",
    parameter="per_100mm",
    per_unit=0.1,
    belongs_to="specimen",
    sentence="the section changes along the beam",
    remedy="measure the width at both ends; swap the ends",
)

STIFFNESS_GRADIENT_AXIAL = Effect(
    name="stiffness-gradient-axial",
    parameter="per_100mm",
    per_unit=0.1,
    belongs_to="specimen",
    sentence="the material is stiffer at one end than at the other",
    remedy="swap the ends of the beam",
)

STIFFNESS_GRADIENT_TRANSVERSE = Effect(
    name="stiffness-gradient-transverse",
    parameter="per_radius",
    per_unit=0.01,
    belongs_to="specimen",
    sentence="the material is stiffer on one side, above or below",
    remedy="turn the beam by 180 degrees about its axis",
)

RESIDUAL_CURVATURE = Effect(
    name="residual-curvature",
    parameter="curvature_per_m",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the specimen has residual curvature from casting: it is bent without any load",
    remedy="turn the beam by 180 degrees about its axis: a bend changes sign",
)

VOID = Effect(
    name="void",
    parameter="lost_EI",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="a void or a cut weakens the beam in one place",
    remedy="look through the beam, or swap its ends: the kink moves along",
)

SKIN = Effect(
    name="skin",
    parameter="excess",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the surface is stiffer or softer than the core",
    remedy="cut the beam and indent both sides; refine the mesh to distinguish it from locking elements",
)

SET_BETWEEN_TESTS = Effect(
    name="set-between-tests",
    parameter="length_percent_per_test",
    per_unit=100.0,
    belongs_to="specimen",
    sentence="the specimen had not recovered between tests: each begins with more permanent set",
    remedy="measure its height before each test, or wait ten times as long between them",
)

TEST_ORDER = Effect(
    name="test-order",
    parameter="stress_percent_per_test",
    per_unit=100.0,
    belongs_to="specimen",
    sentence="the stress changes with the number of the test: the specimen ages, heals or wears, or the load"
    " cell drifts",
    remedy="load a second specimen as often, and weigh the load cell before each test",
)

ADDED_MASS = Effect(
    name="added-mass",
    parameter="mass_g",
    per_unit=1e3,
    belongs_to="specimen",
    sentence="the mass on the free end is not as stated",
    remedy="look at the free end; weigh the beam",
)

THICKNESS = Effect(
    name="thickness",
    parameter="excess_percent",
    per_unit=100.0,
    belongs_to="specimen",
    sentence="the block is thicker, or thinner, than stated",
    remedy="measure the block with callipers",
)

ADHESION = Effect(
    name="adhesion",
    parameter="pull_mN",
    per_unit=1e3,
    belongs_to="specimen",
    sentence="the surface adheres to the indenter and pulls it during retraction",
    remedy="record the retraction until the indenter is free; powder the surface and repeat",
)

INCLUSION_DEBONDED = Effect(
    name="inclusion-debonded",
    parameter="loose_part",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the soft material has detached from the inclusion",
    remedy="pull at the surface above the inclusion, or indent a point far from it",
)

INCLUSION_MISPLACED = Effect(
    name="inclusion-misplaced",
    parameter="shift_mm",
    per_unit=1e3,
    belongs_to="specimen",
    sentence="the inclusion is not at its stated position",
    remedy="indent several points around the inclusion, or locate it by ultrasound",
)
