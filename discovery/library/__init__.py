"""Diagnoses of many recordings: each is diagnosed once, and again only after a change."""
