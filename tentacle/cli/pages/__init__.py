"""The output of a verb for people: a room's result as report, session and figures, drawn by viz."""
