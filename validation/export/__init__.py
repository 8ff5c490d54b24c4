"""Exports held against the recording that made the model, and models that come from another program."""
