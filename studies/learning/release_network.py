"""Copy a run to the networks that come with the package: `learn.pretrained`.

    python -m studies.learning.release_network RUN NAME

Its checkpoint and its tables forget where its dataset lay, so that they are the same on any machine.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import learn.pretrained
from learn.data.tables import TABLES, tables_bytes
from learn.evaluation import load_intervals, save_intervals
from learn.training import load_run, open_tables
from learn.training.run_folder import BEST, load_checkpoint, save_checkpoint, write_whole


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path)
    parser.add_argument("name")
    arguments = parser.parse_args()
    folder = Path(learn.pretrained.__file__).parent / arguments.name
    folder.mkdir(exist_ok=True)
    content = load_checkpoint(arguments.run / BEST)
    content["location"] = Path(content["location"]).name
    save_checkpoint(folder / BEST, content)
    tables = open_tables(load_run(arguments.run))
    write_whole(
        folder / TABLES, tables_bytes(replace(tables, location=content["location"], has_fields=False))
    )
    intervals = load_intervals(load_run(arguments.run))
    assert intervals is not None, f"{arguments.run}: learn.evaluate first"
    save_intervals(load_run(folder), intervals)
    print(f"{folder}: {sum(file.stat().st_size for file in folder.iterdir()) / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
