"""Comparison of an export with the recording from which its model was identified."""
