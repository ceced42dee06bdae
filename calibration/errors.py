"""Errors that people can act on: one sentence, no traceback."""

from __future__ import annotations


class InputError(Exception):
    """Bad input or an unusable target; its text is one sentence for people (exit code 2)."""


class OptionError(InputError):
    """An argument of a function, or the option of a command of the same name, that cannot be used.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : object
        Value that was given; None leaves it out of the sentence.
    expected : str
        The rest of the sentence.
    """

    def __init__(self, name: str, value: object, expected: str) -> None:
        self.name, self.value, self.expected = name, value, expected
        super().__init__(f"{name}{'' if value is None else f' {value}'}: {expected}")

    def __reduce__(self) -> tuple[type[OptionError], tuple[str, object, str]]:
        return OptionError, (self.name, self.value, self.expected)

    @property
    def option(self) -> str:
        """The sentence with the option's name as a command line has it."""
        return f"--{self.name.replace('_', '-')}" + str(self).removeprefix(self.name)
