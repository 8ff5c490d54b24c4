"""The loop decided by posterior mass under one likelihood (inference.latent_force), beside the rules.

Trials on simulators that the project did not write decide which of the two stays.
"""
