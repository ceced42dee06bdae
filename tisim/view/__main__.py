"""`python -m tisim.view`."""

from tisim.view.command import app

if __name__ == "__main__":
    app(prog_name="python -m tisim.view")
