"""Effects of instruments: errors of cameras, clocks and load cells."""

from __future__ import annotations

from calibration.measurements._effect import Effect

CAMERA_ROLL = Effect(
    name="camera-roll",
    parameter="angle_deg",
    per_unit=57.29577951308232,
    belongs_to="camera",
    sentence="the camera is rotated about its axis relative to the rig",
    remedy="put a plumb line or a gauge into the picture",
)

IMAGE_SCALE = Effect(
    name="image-scale",
    parameter="excess",
    per_unit=1.0,
    belongs_to="camera",
    sentence="the camera's scale is off",
    remedy="put a second board, or a gauge of known length, into the beam's plane",
)

LENS_DISTORTION = Effect(
    name="lens-distortion",
    parameter="per_m2",
    per_unit=1.0,
    belongs_to="camera",
    sentence="the lens distorts the photographs",
    remedy="calibrate the lens with a board in several poses",
)

CLOCK_RATE = Effect(
    name="clock-rate",
    parameter="excess",
    per_unit=1.0,
    belongs_to="camera",
    sentence="the cameras' clock is wrong",
    remedy="record a metronome, or another camera's clock",
)

FORCE_GAIN = Effect(
    name="force-gain",
    parameter="excess_percent",
    per_unit=100.0,
    belongs_to="rig",
    sentence="the load cell's scale is off",
    remedy="put a known weight on the load cell",
)

FORCE_OFFSET = Effect(
    name="force-offset",
    parameter="offset_N",
    per_unit=1.0,
    belongs_to="rig",
    sentence="the zero of the force is off",
    remedy="record some seconds before the indenter touches, and tare the load cell",
)

FORCE_DRIFT = Effect(
    name="force-drift",
    parameter="drift_mN_per_s",
    per_unit=1e3,
    belongs_to="rig",
    sentence="the zero of the force drifts",
    remedy="record the free indenter before and after the indentation; let the load cell warm up",
)

STRESS_OFFSET = Effect(
    name="stress-offset",
    parameter="offset_kPa",
    per_unit=1e-3,
    belongs_to="rig",
    sentence="the zero of the force is off",
    remedy="record some seconds before the platen touches, and tare the load cell",
)
