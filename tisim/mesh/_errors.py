"""What a mesh builder says when it cannot make a mesh."""


class MeshError(ValueError):
    """A body cannot be meshed; the message is one sentence that says what to change."""
