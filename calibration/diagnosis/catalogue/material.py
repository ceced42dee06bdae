"""Effects of the material beyond the baseline's law."""

from __future__ import annotations

from calibration.measurements._effect import Effect

DENSITY = Effect(
    name="density",
    parameter="excess",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material is heavier or lighter than stated",
    remedy="weigh the specimen",
    with_material=True,
)

STRAIN_STIFFENING = Effect(
    name="strain-stiffening",
    parameter="c2_over_c1",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material stiffens with strain",
    remedy="photograph a longer beam, or the softest mixture; pull a coupon to large strain",
    with_material=True,
)

SECOND_INVARIANT = Effect(
    name="second-invariant",
    parameter="c01_share",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the stress depends on the second invariant too, so that modes of loading differ",
    remedy="test in another mode (equibiaxial is the most informative), or compress as well as pull",
    with_material=True,
)

LIMITED_EXTENSIBILITY = Effect(
    name="limited-extensibility",
    parameter="one_over_locking_stretch_squared",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material's chains have a finite extensibility: it locks at a finite strain",
    remedy="pull until it locks: only there it differs from a plain stiffening",
    with_material=True,
)

LAW_FORM = Effect(
    name="law-form",
    parameter="in_its_place",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the law has the wrong form for this material",
    remedy="use the law that is named: the card has it, and calibration.fit --model LAW --terms N fits it;"
    " a mode of loading that its fit has not seen confirms its form",
    with_material=True,
)

COMPRESSIBILITY = Effect(
    name="compressibility",
    parameter="poisson_drop",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material is compressible",
    remedy="weigh it under pressure, or compress a bonded cylinder",
    with_material=True,
)

ANISOTROPY = Effect(
    name="anisotropy",
    parameter="fibre_excess",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material is stiffer in one direction than in another",
    remedy="cut specimens along and across, and pull both; add another mode of loading",
    with_material=True,
)

HYSTERESIS = Effect(
    name="hysteresis",
    parameter="unloading_loss",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material dissipates energy: unloading lies below loading",
    remedy="record the unloading too",
    with_material=True,
)

MULLINS = Effect(
    name="mullins",
    parameter="softening",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the first loading softens the material (Mullins): the second one needs less force",
    remedy="load the same specimen twice to the same strain",
    with_material=True,
)

TENSION_COMPRESSION_ASYMMETRY = Effect(
    name="tension-compression-asymmetry",
    parameter="compression_excess",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material is stiffer, or softer, in compression than in tension",
    remedy="pull and press one specimen, bonded to the same plates, through zero",
    with_material=True,
)

PERMANENT_SET = Effect(
    name="permanent-set",
    parameter="part_of_largest_strain",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material keeps part of its largest strain: unloaded, it does not recover its length",
    remedy="measure the specimen's length after the test, at once and an hour later",
    with_material=True,
)

RATE_DEPENDENCE = Effect(
    name="rate-dependence",
    parameter="per_decade",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material is stiffer the faster it is strained",
    remedy="repeat a test at a tenth and at ten times the rate, or hold the largest strain, with time",
    with_material=True,
)

# per_decade: decrease per decade of time, as a fraction of the modulus at 1 s
CREEP = Effect(
    name="creep",
    parameter="per_decade",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material creeps: it gets softer with each decade of time",
    remedy="photograph the same beam at several times",
    with_material=True,
)

# fraction_of_modulus: fraction of the instantaneous modulus that relaxes with the stated relaxation time; if
# none is stated (logarithmic relaxation in indentation), the fraction per decade
RELAXATION = Effect(
    name="relaxation",
    parameter="fraction_of_modulus",
    per_unit=1.0,
    belongs_to="specimen",
    sentence="the material relaxes: its modulus falls with time under load, and depends on the speed",
    remedy="hold a constant load or strain for a minute, or load at a tenth and at ten times the speed",
    with_material=True,
)
