"""A mesh with quadrature, numbering and sparsity, and a material on it."""
