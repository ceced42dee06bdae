"""Batches of scenes on several processes."""
