"""What goes into a session, one topic a file; each function logs columns under a run's path."""
