"""`python -m learn.predict`: one poke by a trained surrogate, with a picture."""

from learn import cli

app = cli.single(cli.predict, cli.PREDICT_EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.predict")
