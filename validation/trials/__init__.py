"""Blind trials of the loop: design, making, scores of the answers, and statistics of the scores."""
