"""Blind trials of the loop: what they are, how answers are scored, what the scores say. They are made elsewhere."""
