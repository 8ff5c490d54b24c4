"""A law of force as data: an expression in known quantities and named parameters, its dimension checked, never eval'ed.

Both models take the same expression and put in their own quantities; this package holds no equation of motion.
"""
