"""What a notebook shows of scenes and runs: cards, pictures, films, plots. No script in any."""
