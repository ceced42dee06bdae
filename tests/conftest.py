"""For all tests."""

from __future__ import annotations

import signal


def pytest_configure() -> None:
    """What is started in the background ignores Ctrl-C, and so would the programs whose Ctrl-C is tested."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
