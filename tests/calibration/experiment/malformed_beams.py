"""Invalid beams: keys, captures and markers."""

from __future__ import annotations

from changes import MARKERS, YAML, Case, cell, drop, put, rename

CASES: dict[str, Case] = {
    # beams
    "unknown key": (
        put("beam", "colour", "red"),
        YAML,
        "unknown key trials[bar].colour:",
        "expected one of id, kind",
    ),
    "radius in m": (
        put("beam", "section", {"circle": {"radius_m": 0.01}}),
        YAML,
        "unknown key trials[bar].section.circle.radius_m:",
        "expected radius_mm",
    ),
    "radius sd in m": (
        put("beam", "section.circle.radius_sd_m", 5e-5),
        YAML,
        "unknown key trials[bar].section.circle.radius_sd_m:",
        "expected radius_sd_mm",
    ),
    "free length in m": (
        rename("beam", "free_length_mm", "free_length_m"),
        YAML,
        "unknown key trials[bar].free_length_m:",
        "expected free_length_mm",
    ),
    "gravity's unit": (
        rename("beam", "gravity_m_s2", "gravity_mm_s2"),
        YAML,
        "unknown key trials[bar].gravity_mm_s2:",
        "expected gravity_m_s2",
    ),
    "gravity in mm/s2": (
        put("beam", "gravity_m_s2", [0.0, 0.0, -9810.0]),
        YAML,
        "key trials[bar].gravity_m_s2:",
        "expected a length of at most 100 m/s2",
    ),
    "gravity of two numbers": (
        put("beam", "gravity_m_s2", [0.0, -9.81]),
        YAML,
        "key trials[bar].gravity_m_s2:",
        "expected more numbers",
    ),
    "radius 0": (
        put("beam", "section.circle.radius_mm", 0.0),
        YAML,
        "key trials[bar].section.circle.radius_mm:",
        "expected more than 0, got 0.0",
    ),
    "radius sd negative": (
        put("beam", "section.circle.radius_sd_mm", -0.1),
        YAML,
        "key trials[bar].section.circle.radius_sd_mm:",
        "expected 0 or more",
    ),
    "radius sd as large as the radius": (
        put("beam", "section.circle.radius_sd_mm", 10.0),
        YAML,
        "key trials[bar].section.circle.radius_sd_mm:",
        "expected less than radius_mm = 10",
    ),
    "no section": (
        put("beam", "section", {}),
        YAML,
        "key trials[bar].section:",
        "expected exactly one of circle, rectangle",
    ),
    "length 0": (
        put("beam", "free_length_mm", 0),
        YAML,
        "key trials[bar].free_length_mm:",
        "expected more than 0, got 0",
    ),
    "length infinite": (
        put("beam", "free_length_mm", float("inf")),
        YAML,
        "key trials[bar].free_length_mm:",
        "expected a",
    ),
    "length as text": (
        put("beam", "free_length_mm", "100 mm"),
        YAML,
        "key trials[bar].free_length_mm:",
        "expected a number, got '100 mm'",
    ),
    "no length": (
        drop("beam", "free_length_mm"),
        YAML,
        "missing key trials[bar].free_length_mm:",
        "expected it here",
    ),
    "grip negative": (
        put("beam", "grip_length_mm", -20.0),
        YAML,
        "key trials[bar].grip_length_mm:",
        "expected more than 0",
    ),
    "supports": (
        put("beam", "supports", "hinged"),
        YAML,
        "key trials[bar].supports:",
        "expected 'clamped-free' or 'clamped-clamped', got 'hinged'",
    ),
    "tip force between clamps": (
        lambda s: s.beam.update(supports="clamped-clamped", tip_force_N=[0.0, 0.0, -1.0]),
        YAML,
        "key trials[bar].tip_force_N:",
        "expected none between two clamps",
    ),
    "nothing measured": (
        drop("beam", "captures", "markers", "marker_positions_mm", "marker_sd_mm"),
        YAML,
        "key trials[bar].captures:",
        "expected captures or markers",
    ),
    "captures empty": (
        put("beam", "captures", []),
        YAML,
        "key trials[bar].captures:",
        "expected at least 1",
    ),
    "captures no list": (
        lambda s: s.beam.update(captures=s.capture),
        YAML,
        "key trials[bar].captures:",
        "expected a list",
    ),
    "capture of nothing": (
        lambda s: s.beam.update(captures=[{"time_s": 1.0}]),
        YAML,
        "key trials[bar].captures[#1].outline:",
        "expected an outline or a photo",
    ),
    "captures out of order": (
        lambda s: s.capture.update(time_s=500.0),
        YAML,
        "key trials[bar].captures[#2].time_s:",
        "expected 500 or more",
    ),
    "capture at no time": (
        put("capture", "time_s", 0.0),
        YAML,
        "key trials[bar].captures[#1].time_s:",
        "expected more than 0",
    ),
    "photo without board": (
        drop("capture", "photo_checkerboard"),
        YAML,
        "key trials[bar].captures[#1].photo_checkerboard:",
        "expected it beside a photo",
    ),
    "board without photo": (
        drop("capture", "photo"),
        YAML,
        "key trials[bar].captures[#1].photo_checkerboard:",
        "expected a photo beside it",
    ),
    "outline without sd": (
        drop("capture", "outline_sd_mm"),
        YAML,
        "key trials[bar].captures[#1].outline_sd_mm:",
        "expected it beside an outline",
    ),
    "outline sd 0": (
        put("capture", "outline_sd_mm", 0.0),
        YAML,
        "key trials[bar].captures[#1].outline_sd_mm:",
        "expected more than 0",
    ),
    "outline without correlation": (
        drop("capture", "outline_correlation_mm"),
        YAML,
        "key trials[bar].captures[#1].outline_correlation_mm:",
        "expected it beside an outline",
    ),
    "outline without registration": (
        drop("capture", "registration_sd"),
        YAML,
        "key trials[bar].captures[#1].registration_sd:",
        "expected it beside an outline",
    ),
    "roll in rad": (
        put("capture", "registration_sd", {"roll_rad": 0.01}),
        YAML,
        "unknown key trials[bar].captures[#1].registration_sd.roll_rad:",
        "expected roll_deg",
    ),
    "markers without positions": (
        drop("beam", "marker_positions_mm"),
        YAML,
        "key trials[bar].marker_positions_mm:",
        "expected it beside markers",
    ),
    "positions without markers": (
        drop("beam", "markers"),
        YAML,
        "key trials[bar].markers:",
        "expected it beside marker_positions_mm",
    ),
    "markers without sd": (
        drop("beam", "marker_sd_mm"),
        YAML,
        "key trials[bar].marker_sd_mm:",
        "expected it beside markers",
    ),
    "position without rows": (
        put("beam", "marker_positions_mm.tip2", [1.0, 2.0, 3.0]),
        YAML,
        "key trials[bar].marker_positions_mm.tip2:",
        "expected rows of this marker in beams/bar-markers.csv",
    ),
    "rows without position": (
        lambda s: s.beam["marker_positions_mm"].pop("base"),
        MARKERS,
        "line 5: column marker:",
        "expected one of marker_positions_mm (tip1), got 'base'",
    ),
    "marker's time back": (
        cell(MARKERS, "time_s", 4, 0.0),
        MARKERS,
        "line 6: column time_s:",
        "expected more than 0 s of marker base",
    ),
    "marker's time before 0": (
        cell(MARKERS, "time_s", 4, -1.0),
        MARKERS,
        "line 6: column time_s:",
        "expected 0 s or more, got -1",
    ),
    "marker far off": (
        cell(MARKERS, "uz_mm", 1, -900.0),
        MARKERS,
        "line 3: column uz_mm:",
        "expected at most 300",
    ),
    "marker's place far off": (
        put("beam", "marker_positions_mm.tip1", [94e3, 0.0, 0.0]),
        YAML,
        "key trials[bar].marker_positions_mm.tip1:",
        "expected a place within 300 mm",
    ),
}
