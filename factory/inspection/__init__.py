"""What a store contains: summaries, features of its pokes, and pictures."""
