"""`python -m learn.train`: train a surrogate on a dataset of pokes."""

from learn import cli

app = cli.single(cli.train, cli.TRAIN_EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.train")
