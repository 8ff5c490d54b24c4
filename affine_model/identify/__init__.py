"""Identification: the trajectory fit on any number of recordings, and the paper's regression (eq. 18-19)."""
