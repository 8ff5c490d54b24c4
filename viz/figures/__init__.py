"""Figures, one a file: each takes plain data and returns a matplotlib Figure with units on every axis."""
