"""Closing the loop: the residual, the effect behind it, the error before and after, and an honest "unknown"."""
