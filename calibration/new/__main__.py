"""`python -m calibration.new`."""

from calibration.new import app

if __name__ == "__main__":
    app()
