"""`python -m learn`: the commands and what each does."""

from learn.cli import app
from learn.page import command as _page  # noqa: F401 - adds its command

if __name__ == "__main__":
    app(prog_name="python -m learn")
