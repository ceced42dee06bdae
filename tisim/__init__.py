"""tisim: many soft bodies at once, by hyperelastic finite elements. SI units."""
