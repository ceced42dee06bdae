"""`python -m learn`: the commands and what each does."""

from learn.cli import app

if __name__ == "__main__":
    app(prog_name="python -m learn")
