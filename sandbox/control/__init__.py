"""Control laws: what a controller wants of its drives, from what it reads. One law a file."""
