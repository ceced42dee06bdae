"""`python -m learn.export`: a trained surrogate as ONNX files, checked."""

from learn import cli

app = cli.single(cli.export, cli.EXPORT_EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.export")
