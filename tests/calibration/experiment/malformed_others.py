"""Other invalid input: the experiment as a whole, pokes and coupons."""

from __future__ import annotations

from changes import PULL, RECORD, SCAN, YAML, Case, cell, drop, put, rename, rows

CASES: dict[str, Case] = {
    # the whole
    "version 2": (lambda s: s.more.update(format=2), YAML, "key format:", "expected 1, got 2"),
    "version true": (lambda s: s.more.update(format=True), YAML, "key format:", "expected 1"),
    "no trials": (lambda s: s.trials.clear(), YAML, "key trials:", "expected at least 1, got 0"),
    "unknown key at the top": (
        lambda s: s.more.update(note="x"),
        YAML,
        "unknown key note:",
        "expected notes",
    ),
    "unknown kind": (
        put("beam", "kind", "shell"),
        YAML,
        "key trials[bar].kind:",
        "expected beam, poke or coupon",
    ),
    "no kind": (
        drop("beam", "kind"),
        YAML,
        "missing key trials[bar].kind:",
        "expected beam, poke or coupon",
    ),
    "unknown material": (
        put("poke", "material", "S9"),
        YAML,
        "key trials[poke].material:",
        "expected a name of materials (S0), got 'S9'",
    ),
    "id twice": (
        put("poke", "id", "bar"),
        YAML,
        "key trials:",
        "expected different ids, trial #2 has the id bar",
    ),
    "ids that differ in case alone": (
        put("poke", "id", "BAR"),
        YAML,
        "key trials:",
        "expected ids that differ in more than letter case, trial #2 has the id BAR, another bar",
    ),
    "materials that differ in case alone": (
        lambda s: s.materials.update(s0=s.materials["S0"]),
        YAML,
        "key materials:",
        "expected names that differ in more than letter case, got S0 and s0",
    ),
    "id that is a number": (put("beam", "id", 7), YAML, "key trials[#1].id:", "expected text, got 7"),
    "trial that is text": (lambda s: s.trials.append("bar"), YAML, "key trials[#4]", "expected"),
    "materials empty": (lambda s: s.materials.clear(), YAML, "key materials:", "expected at least 1"),
    "density 0": (
        lambda s: s.materials["S0"].update(density_kg_m3=0.0),
        YAML,
        "key materials.S0.density_kg_m3:",
        "expected more than 0",
    ),
    "density negative": (
        lambda s: s.materials["S0"].update(density_kg_m3=-1e3),
        YAML,
        "key materials.S0.density_kg_m3:",
        "expected more than 0",
    ),
    "density in g/cm3": (
        lambda s: s.materials["S0"].update(density_kg_m3=1.0),
        YAML,
        "key materials.S0.density_kg_m3:",
        "expected 10 to 30000 kg/m3",
    ),
    "density's unit": (
        lambda s: s.materials["S0"].update(density_g_cm3=1.0),
        YAML,
        "unknown key materials.S0.density_g_cm3:",
        "expected density_kg_m3",
    ),
    "density sd negative": (
        lambda s: s.materials["S0"].update(density_sd_kg_m3=-5.0),
        YAML,
        "key materials.S0.density_sd_kg_m3:",
        "expected 0 or more",
    ),
    "density NaN": (
        lambda s: s.materials["S0"].update(density_kg_m3=float("nan")),
        YAML,
        "key materials.S0.density_kg_m3:",
        "expected a finite number",
    ),
    "material without value": (
        lambda s: s.materials.update(S1=None),
        YAML,
        "key materials.S1:",
        "expected keys and values",
    ),
    # pokes
    "poke's time before 0": (
        cell(RECORD, "time_s", 0, -0.5),
        RECORD,
        "line 2: column time_s:",
        "expected 0 s or more, got -0.5",
    ),
    "poke's time stands": (
        cell(RECORD, "time_s", 2, 1.0),
        RECORD,
        "line 4: column time_s:",
        "expected more than 1 s before it, got 1",
    ),
    "poke of two rows": (
        rows(RECORD, [0, 1]),
        RECORD,
        "",
        "expected at least 3 rows below the header, got 2",
    ),
    "depth in um": (
        cell(RECORD, "depth_mm", 1, 2000.0),
        RECORD,
        "line 3: column depth_mm:",
        "expected at most 300",
    ),
    "two force components": (
        lambda s: s.tables[RECORD].pop("force_y_N"),
        RECORD,
        "line 1: missing column force_y_N",
        "expected force_x_N, force_y_N, force_z_N together",
    ),
    "direction 0": (
        put("poke", "direction", [0.0, 0.0, 0.0]),
        YAML,
        "key trials[poke].direction:",
        "expected a direction",
    ),
    "direction up": (
        put("poke", "direction", [0.0, 0.0, 1.0]),
        YAML,
        "key trials[poke].direction:",
        "expected one into the block",
    ),
    "out through a side": (
        lambda s: s.poke.update(start_mm=[-49.0, 0.0, 32.0], direction=[-4.0, 0.0, -3.0]),
        YAML,
        "key trials[poke].direction:",
        "expected a path within the block's sides (x within +-50, y within +-50 mm), at the 2 mm of",
    ),
    "start beside the block": (
        put("poke", "start_mm", [60.0, 0.0, 32.0]),
        YAML,
        "key trials[poke].start_mm:",
        "expected a point above the block's base",
    ),
    "rod radius negative": (
        put("poke", "rod.radius_mm", -2.5),
        YAML,
        "key trials[poke].rod.radius_mm:",
        "expected more than 0",
    ),
    "rod tip": (
        put("poke", "rod.tip", "cone"),
        YAML,
        "key trials[poke].rod.tip:",
        "expected 'flat' or 'hemisphere', got 'cone'",
    ),
    "block side 0": (
        put("poke", "block_mm", [100.0, 0.0, 32.0]),
        YAML,
        "key trials[poke].block_mm[#2]:",
        "expected more than 0",
    ),
    "block of four": (
        put("poke", "block_mm", [1.0, 2.0, 3.0, 4.0]),
        YAML,
        "key trials[poke].block_mm:",
        "expected at most 3, got 4",
    ),
    "two inclusions": (
        put("poke", "inclusion.mesh", "a.stl"),
        YAML,
        "key trials[poke].inclusion:",
        "expected exactly one of sphere, box, cylinder, mesh",
    ),
    "unknown inclusion": (
        put("poke", "inclusion", {"cone": {}}),
        YAML,
        "unknown key trials[poke].inclusion.cone:",
        "expected one of sphere, box, cylinder, mesh",
    ),
    "inclusion mesh missing": (
        put("poke", "inclusion", {"mesh": "a.stl"}),
        YAML,
        "key trials[poke].inclusion.mesh:",
        "expected the file a.stl",
    ),
    "inclusion outside": (
        put("poke", "inclusion.sphere.centre_mm", [0.0, 80.0, 8.0]),
        YAML,
        "key trials[poke].inclusion:",
        "expected a centre inside the block",
    ),
    "force sd 0": (
        put("poke", "force_sd_N", 0.0),
        YAML,
        "key trials[poke].force_sd_N:",
        "expected more than 0",
    ),
    "force sd of another unit": (
        put("poke", "force_sd_N", 10.0),  # mN
        YAML,
        "key trials[poke].force_sd_N:",
        "expected less than the largest force of pokes/poke.csv in N, 0.5, got 10",
    ),
    "depth sd of another unit": (
        put("poke", "depth_sd_mm", 20.0),  # micrometres
        YAML,
        "key trials[poke].depth_sd_mm:",
        "expected less than the largest depth of",
    ),
    "force sd's unit": (
        rename("poke", "force_sd_N", "force_sd_mN"),
        YAML,
        "unknown key trials[poke].force_sd_mN:",
        "expected force_sd_N",
    ),
    "scan far off": (cell(SCAN, "z_mm", 2, 3200.0), SCAN, "line 4: column z_mm:", "expected at most 300"),
    "scans out of order": (
        lambda s: s.poke["surfaces"].append({**s.poke["surfaces"][0], "time_s": 1.0}),
        YAML,
        "key trials[poke].surfaces[#2].time_s:",
        "expected more than 2",
    ),
    # coupons
    "stretch 0": (
        cell(PULL, "stretch", 1, 0.0),
        PULL,
        "line 3: column stretch:",
        "expected more than 0, got 0",
    ),
    "strain for stretch": (
        cell(PULL, "stretch", 0, -0.1),
        PULL,
        "line 2: column stretch:",
        "expected more than 0",
    ),
    "coupon of two rows": (rows(PULL, [0, 1]), PULL, "", "expected at least 3 rows below the header, got 2"),
    "coupon's time before 0": (
        cell(PULL, "time_s", 0, -1.0),
        PULL,
        "line 2: column time_s:",
        "expected 0 s or more, got -1",
    ),
    "coupon's time back": (
        cell(PULL, "time_s", 2, 0.5),
        PULL,
        "line 4: column time_s:",
        "expected more than 1 s before it, got 0.5",
    ),
    "mode": (
        put("coupon", "mode", "biaxial"),
        YAML,
        "key trials[pull].mode:",
        "expected 'uniaxial', 'equibiaxial', 'planar' or 'simple-shear'",
    ),
    "stress sd 0": (
        put("coupon", "stress_sd_kPa", 0.0),
        YAML,
        "key trials[pull].stress_sd_kPa:",
        "expected more than 0",
    ),
    "stress sd of another unit": (
        put("coupon", "stress_sd_kPa", 500.0),  # Pa
        YAML,
        "key trials[pull].stress_sd_kPa:",
        "expected less than the largest stress of",
    ),
    "stretch sd in percent": (
        put("coupon", "stretch_sd", 0.2),
        YAML,
        "key trials[pull].stretch_sd:",
        "expected less than the largest strain of",
    ),
    "stretch in percent": (
        lambda s: s.tables[PULL].update(stretch=[100.0, 110.0, 120.0]),
        PULL,
        "column stretch:",
        "is the column in percent",
    ),
    "key without value": (
        put("coupon", "stress_sd_kPa", None),
        YAML,
        "key trials[pull].stress_sd_kPa:",
        "expected a value, or the key left out",
    ),
}
