"""`python -m learn.evaluate`: a surrogate's errors and intervals on test pokes, with a report."""

from learn import cli

app = cli.single(cli.evaluate, cli.EVALUATE_EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.evaluate")
