"""A rod pushed into a block, with frictional contact."""
