"""From a file to data, and what is reported when it cannot be read."""
