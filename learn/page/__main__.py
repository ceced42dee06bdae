"""`python -m learn.page`: a trained surrogate as a page that opens from disk."""

from learn.page.command import app

if __name__ == "__main__":
    app(prog_name="python -m learn.page")
