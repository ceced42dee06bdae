"""Programs that cards are exported to: a file each."""
