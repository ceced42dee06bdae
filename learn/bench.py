"""`python -m learn.bench`: latency of a surrogate, throughput of the loaders."""

from learn import cli

app = cli.single(cli.bench, cli.BENCH_EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.bench")
