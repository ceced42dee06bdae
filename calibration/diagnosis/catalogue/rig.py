"""Effects of the rig: deviations of supports and loads from the stated ones."""

from __future__ import annotations

from calibration.measurements._effect import Effect

GRIP_LENGTH = Effect(
    name="grip-length",
    parameter="depth_mm",
    per_unit=1e3,
    belongs_to="rig",
    sentence="the grips hold the beam deeper inside than at their faces",
    remedy="clamp a metal bar and measure where the grip holds it",
)

GRIP_SQUEEZE = Effect(
    name="grip-squeeze",
    parameter="squeeze",
    per_unit=1.0,
    belongs_to="rig",
    sentence="the grips squeeze the section that they hold",
    remedy="measure the beam's height next to the clamp; cast a collar on the specimen",
)

CLAMP_COMPLIANCE = Effect(
    name="clamp-compliance",
    parameter="rad_per_Nm",
    per_unit=1.0,
    belongs_to="rig",
    sentence="the clamps rotate under the moment that they carry",
    remedy="load the clamp with a known moment and measure its rotation",
)

CLAMP_TILT = Effect(
    name="clamp-tilt",
    parameter="angle_deg",
    per_unit=57.29577951308232,
    belongs_to="rig",
    sentence="the near clamp is tilted",
    remedy="lay a spirit level on the clamp",
)

CLAMP_SAG = Effect(
    name="clamp-sag",
    parameter="mm_per_N",
    per_unit=1e3,
    belongs_to="rig",
    sentence="the clamp sinks under the weight that it carries",
    remedy="hang a known weight on the clamp and measure how far it sinks",
)

CLAMP_GAP = Effect(
    name="clamp-gap",
    parameter="gap_mm",
    per_unit=1e3,
    belongs_to="rig",
    sentence="the beam held at both ends is slack or stretched",
    remedy="measure the distance of the clamps with a gauge block, and the specimen's length",
)

FREE_LENGTH = Effect(
    name="free-length",
    parameter="slip_mm",
    per_unit=1e3,
    belongs_to="rig",
    sentence="the beam has slipped in its grip: its free length is not as stated",
    remedy="set the free length with a gauge block, and mark the beam at the clamp's face",
)

GRAVITY_TILT = Effect(
    name="gravity-tilt",
    parameter="angle_deg",
    per_unit=57.29577951308232,
    belongs_to="rig",
    sentence="the rig is tilted: gravity does not act along its vertical axis",
    remedy="level the rig, or hang a plumb line in the picture",
)

LOAD_HEIGHT = Effect(
    name="load-height",
    parameter="height_mm",
    per_unit=1e3,
    belongs_to="rig",
    sentence="the mass hangs above or below the middle of the end face",
    remedy="measure where on the end face the mass hangs",
)

LOOSE_LOAD = Effect(
    name="loose-load",
    parameter="part_of_inertia",
    per_unit=1.0,
    belongs_to="rig",
    sentence="the hung mass is attached loosely: it does not move with the beam as one body",
    remedy="clamp or glue the mass to the end face, and repeat",
)

HELD_POSE = Effect(
    name="held-pose",
    parameter="below_straight_mm",
    per_unit=1e3,
    belongs_to="rig",
    sentence="the beam was not held straight before its release",
    remedy="hold it against a straight edge, or photograph it as it is held",
)

RUBBING_LOAD = Effect(
    name="rubbing-load",
    parameter="held_by_friction_mm",
    per_unit=1e3,
    belongs_to="rig",
    sentence="dry friction where the hung mass is attached damps the beam",
    remedy="glue the mass to the end face, or let the beam vibrate with a mass that is cast in",
)

AIR_DRAG = Effect(
    name="air-drag",
    parameter="rate_per_s",
    per_unit=1.0,
    belongs_to="rig",
    sentence="a drag in proportion to mass and velocity (air) damps the beam, in addition to the material",
    remedy="let it vibrate in a box or a vacuum, and with other masses",
)

PLATEN_FRICTION = Effect(
    name="platen-friction",
    parameter="mu_d_over_3h",
    per_unit=1.0,
    belongs_to="rig",
    sentence="friction at the platens restrains the ends of the compressed specimen",
    remedy="lubricate the platens, or compress cylinders of two heights",
)

PLATEN_BONDING = Effect(
    name="platen-bonding",
    parameter="part_of_bonded",
    per_unit=1.0,
    belongs_to="rig",
    sentence="the platens restrain the ends of the compressed cylinder by friction or adhesion",
    remedy="lubricate the platens and repeat, or compress cylinders of two heights",
)

PLATEN_SLIP = Effect(
    name="platen-slip",
    parameter="coefficient",
    per_unit=1.0,
    belongs_to="rig",
    sentence="the ends of the compressed cylinder slip in part on the platens, with Coulomb friction",
    remedy="lubricate the platens and repeat, or compress cylinders of two heights",
)

PLATEN_TILT = Effect(
    name="platen-tilt",
    parameter="gap_percent",
    per_unit=100.0,
    belongs_to="rig",
    sentence="platen and end face are not parallel: an edge touches first",
    remedy="seat the platen on a ball, or measure the gap with feelers before the test",
)

GAUGE_LENGTH = Effect(
    name="gauge-length",
    parameter="strain_percent",
    per_unit=100.0,
    belongs_to="rig",
    sentence="the strain is not that of the specimen's middle: its ends stretch less, or slip in the grips",
    remedy="measure the strain by two marks on the middle of the specimen",
)

MACHINE_COMPLIANCE = Effect(
    name="machine-compliance",
    parameter="strain_per_MPa",
    per_unit=1e6,
    belongs_to="rig",
    sentence="the rig is compliant, and its deformation is taken for the specimen's",
    remedy="measure the strain on the specimen itself (gauge marks), or test a steel bar in the same grips",
)

STRAIN_OFFSET = Effect(
    name="strain-offset",
    parameter="offset_percent",
    per_unit=100.0,
    belongs_to="rig",
    sentence="the zero of the strain is off: the specimen was slack or preloaded at the start",
    remedy="begin at a stated small preload, or record through zero into the other sign",
)

ROD_ANGLE = Effect(
    name="rod-angle",
    parameter="tilt_deg",
    per_unit=57.29577951308232,
    belongs_to="rig",
    sentence="the indenter is inclined more than stated",
    remedy="put a square against the indenter, or record the force across it too",
)

FRICTION = Effect(
    name="friction",
    parameter="coefficient_above_0.6",
    per_unit=1.0,
    belongs_to="rig",
    sentence="the friction between indenter and block is smaller, or larger, than assumed",
    remedy="powder the indenter, or glue sandpaper on it, and indent the same point again",
)

DEPTH_OFFSET = Effect(
    name="depth-offset",
    parameter="offset_mm",
    per_unit=1e3,
    belongs_to="rig",
    sentence="the zero of the depth is off: the indenter is deeper, or less deep, than recorded",
    remedy="begin the record above the surface, so that the first touch is in it",
)
