"""When a coupon is taken for compressed."""

PRESSED = 0.97  # stretch below which platens press
