"""From a recording to a fitted model: what was seen, with which noise, and the parameters that explain it."""
