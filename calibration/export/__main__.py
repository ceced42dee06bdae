"""`python -m calibration.export`."""

from calibration.export.command import app

if __name__ == "__main__":
    app()
