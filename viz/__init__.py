"""Rerun sessions and their views, figures, and the HTML report. Imports the shared words only."""
