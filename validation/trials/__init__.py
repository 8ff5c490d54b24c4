"""Blind trials of the loop: what they are, how they are made, how answers are scored, what the scores say."""
