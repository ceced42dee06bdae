"""The files of one experiment: each is read once, and what was read goes into the digest."""

from __future__ import annotations

import hashlib
from pathlib import Path

from calibration.errors import InputError

MAIN = "experiment.yaml"


class Files:
    """Reads files by the names that experiment.yaml gives them; refuses those that lie outside the folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._sums: dict[str, str] = {}
        if not folder.is_dir():
            raise InputError(f"{folder}: expected a folder that holds {MAIN}")

    @property
    def main(self) -> Path:
        return self.folder / MAIN

    def error(self, key: str, text: str) -> InputError:
        """What is wrong with a key of experiment.yaml, as one sentence."""
        return InputError(f"{self.main}: key {key}: {text}" if key else f"{self.main}: {text}")

    def read(self, name: str, key: str) -> bytes:
        """Content of the file that `key` names; InputError where it is missing or leads out of the folder."""
        path = self.folder / name
        try:
            real = path.resolve(strict=True)
            if not real.is_relative_to(self.folder.resolve()) or real.suffix != path.suffix:
                raise self.error(
                    key, f"expected a file inside the experiment's folder, {name} leads elsewhere"
                )
            if not real.is_file():
                raise self.error(key, f"expected a file, {name} is none")
            content = real.read_bytes()
        except FileNotFoundError:
            if name == MAIN:
                raise InputError(f"{path}: missing, expected it in the experiment's folder") from None
            raise self.error(
                key, f"expected the file {name} in the experiment's folder, it is missing"
            ) from None
        except (OSError, RuntimeError) as error:  # RuntimeError: links in a circle
            reason = getattr(error, "strerror", None) or "links in a circle"
            raise self.error(key, f"expected that {path} can be read ({reason})") from None
        self._sums[name] = hashlib.sha256(content).hexdigest()
        return content

    def digest(self) -> str:
        """sha256 over the names and contents of all that was read, sorted by name."""
        total = hashlib.sha256()
        for name, content in sorted(self._sums.items()):
            total.update(f"{name}\0{content}\n".encode())
        return total.hexdigest()
