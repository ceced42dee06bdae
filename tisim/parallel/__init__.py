"""A batch of scenes over processes."""
