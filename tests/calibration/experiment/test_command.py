"""Exit codes of a command: 2 for invalid input, 130 for Ctrl-C, with one sentence in both cases."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest

from calibration.cli import plain_ends

CODE = """
import sys, time, typer
from calibration.cli import plain_ends
from calibration.errors import InputError
app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)

@app.command()
@plain_ends({options})
def main() -> None:
    {body}

app()
"""


def _start(body: str, options: str = "") -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", CODE.format(body=body, options=options)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize(
    ("body", "code", "sentence"),
    [
        ("raise InputError('a.yaml: key b: expected c')", 2, "error: a.yaml: key b: expected c\n"),
        ("raise InputError('two\\nlines')", 2, "error: two lines\n"),
        ("open('/no/such/file')", 2, "error: cannot use /no/such/file: No such file or directory\n"),
        ("print('fine')", 0, ""),
    ],
)
def test_ends(body: str, code: int, sentence: str) -> None:
    process = _start(body)
    out, err = process.communicate(timeout=600)
    assert (process.returncode, err) == (code, sentence)
    assert out == ("fine\n" if code == 0 else "")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_ends_in_a_sentence(number: signal.Signals) -> None:
    process = _start("print('on', flush=True); time.sleep(60)", "'Stopped early.'")
    assert process.stdout is not None
    assert process.stdout.readline() == "on\n"
    os.kill(process.pid, number)
    _, err = process.communicate(timeout=600)
    assert (process.returncode, err) == (130, "Stopped early.\n")


def test_faults_of_the_program_are_not_dressed_up() -> None:
    process = _start("raise ZeroDivisionError('ours')")
    _, err = process.communicate(timeout=600)
    assert process.returncode == 1
    assert "ZeroDivisionError: ours" in err


def test_the_signal_is_given_back() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with plain_ends():
        assert signal.getsignal(signal.SIGTERM) is not before
    assert signal.getsignal(signal.SIGTERM) is before
