"""Tests of the models and of the loop: blind trials, the ladder, the validity map, the paper's arms.

It uses discovery and the reference; only the command line uses it.
"""
