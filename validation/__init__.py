"""Whether to believe models and loop: blind trials, the ladder, the validity map, the paper's arms.

It stands above discovery and the reference, and nothing stands on it but the command line.
"""
