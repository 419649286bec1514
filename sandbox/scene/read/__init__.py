"""From a file to data, and what is told when it cannot be read."""
