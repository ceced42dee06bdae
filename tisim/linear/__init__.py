"""Linear algebra of block matrices: sparsity, direct solvers, condensation, preconditioned GMRES."""
