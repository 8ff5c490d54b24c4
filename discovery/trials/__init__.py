"""Blind trials of the loop: what they are, how answers are scored, what the scores say. Recordings come from outside."""
