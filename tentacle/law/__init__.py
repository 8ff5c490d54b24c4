"""A force law as data: an expression in known quantities and named parameters, with a check of its dimension and
without eval.

Both models use the same expression with their own quantities; this package has no equation of motion.
"""
