"""From a file to a scene, or to diagnostics with their places."""
