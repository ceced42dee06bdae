"""Invalid parameters raise an error of one sentence that states the expectation."""

from dataclasses import replace

import pytest

from tisim import laws

OGDEN = {"mu": (1e3, 2e3), "alpha": (2.0, 3.0), "bulk": 1e5}
BAD = [
    ("neo-hookean", {"mu": 1e3}, "expected parameters mu, lam; missing: lam"),
    ("neo-hookean", {"mu": 1e3, "lam": 1e5, "nu": 0.4}, "expected parameters mu, lam; unknown: nu"),
    ("neo-hookean", {"mu": (1e3, 2e3), "lam": 1e5}, r"parameter mu \[Pa\]: expected one number"),
    ("neo-hookean", {"mu": float("nan"), "lam": 1e5}, r"parameter mu \[Pa\]: expected finite numbers"),
    ("neo-hookean", {"mu": 1e3, "lam": float("inf")}, r"parameter lam \[Pa\]: expected finite numbers"),
    ("neo-hookean", {"mu": "soft", "lam": 1e5}, r"parameter mu \[Pa\]: expected finite numbers"),
    ("neo-hookean", {"mu": None, "lam": 1e5}, r"parameter mu \[Pa\]: expected finite numbers"),
    (
        "neo-hookean",
        {"mu": -1e3, "lam": 1e5},
        "small-strain shear and bulk modulus must be positive, got -1000",
    ),
    ("stable-neo-hookean", {"mu": 1e3, "lam": -1e3}, "shear and bulk modulus must be positive"),
    ("st-venant-kirchhoff", {"mu": 0.0, "lam": 1e5}, "shear and bulk modulus must be positive"),
    ("mooney-rivlin", {"c10": 1e3, "c01": -1e3, "bulk": 1e5}, "shear and bulk modulus must be positive"),
    ("ogden", OGDEN | {"alpha": (2.0,)}, "mu, alpha must have the same number of terms"),
    ("ogden", OGDEN | {"mu": (), "alpha": ()}, r"parameter mu \[Pa\]: expected finite numbers"),
    ("ogden", OGDEN | {"mu": ((1e3, 2e3),)}, r"parameter mu \[Pa\]: expected a plain series of numbers"),
    ("ogden", OGDEN | {"alpha": (2.0, 0.0)}, r"parameter alpha \[-\]: expected exponents other than 0"),
    ("ogden", OGDEN | {"alpha": (-2.0, -3.0)}, "shear and bulk modulus must be positive"),
    ("arruda-boyce", {"mu": 1e3, "locking": 0.0, "bulk": 1e5}, "locking .*: expected a stretch above 1"),
    ("arruda-boyce", {"mu": 1e3, "locking": 2.0, "bulk": 0.0}, "shear and bulk modulus must be positive"),
    ("eight-chain", {"mu": 1e3, "locking": 1.0, "bulk": 1e5}, "locking .*: expected a stretch above 1, to"),
    ("yeoh", {"mu": 1e3, "stiffening": -0.1, "bulk": 1e5}, "stiffening must not be negative, got -0.1"),
]


@pytest.mark.parametrize(("law", "parameters", "message"), BAD)
def test_unsound_parameters_get_one_sentence(law, parameters, message):
    with pytest.raises(ValueError, match=message) as caught:
        laws.get(law).check(parameters)
    text = str(caught.value)
    assert text.startswith(f"{law}: ")
    assert "\n" not in text
    assert len(text) < 140


@pytest.mark.parametrize("law", laws.all_names())
def test_sound_parameters_pass(law):
    laws.get(law).check(laws.get(law).from_moduli(3e4, 6e5))


def test_one_term_may_be_a_plain_number():
    laws.get("ogden").check({"mu": 1e3, "alpha": 2.0, "bulk": 1e5})


def test_unknown_law_names_the_ones_there_are():
    with pytest.raises(ValueError, match=r"expected one of st-venant-kirchhoff, .*yeoh, .*, got 'hooke'"):
        laws.get("hooke")


def test_parameters_that_look_like_those_just_found_valid_are_checked() -> None:
    law, good = laws.get("neo-hookean"), {"mu": 1.0, "lam": 20.0}
    for bad in ({**good, "mu": True}, {**good, "mu": -1.0}, {**good, "mu": float("nan")}, {"mu": 1.0}):
        law.check(good)
        with pytest.raises(ValueError, match="neo-hookean: "):
            law.check(bad)  # type: ignore[arg-type]
    ogden, series = laws.get("ogden"), [1.0]
    given = {"mu": series, "alpha": [2.0], "bulk": 20.0}
    ogden.check(given)  # type: ignore[arg-type]
    series[0] = float("nan")
    with pytest.raises(ValueError, match="expected finite numbers"):
        ogden.check(given)  # type: ignore[arg-type]
    # another law of the same name has its own rules
    law.check(good)
    other = replace(law, fault=lambda _: "no")
    with pytest.raises(ValueError, match="neo-hookean: no"):
        other.check(good)
