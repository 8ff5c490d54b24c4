"""The page of `tentacle app`: from a film to a verdict in a browser, on this machine alone."""
