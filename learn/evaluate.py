"""`python -m learn.evaluate`: see `learn.cli.evaluate`."""

from learn import cli

app = cli.single(cli.evaluate, cli.EVALUATE_EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.evaluate")
