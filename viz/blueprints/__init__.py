"""How a session is laid out, one verb a file: each function returns a Rerun blueprint."""
