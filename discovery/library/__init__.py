"""What the loop says of many recordings: each diagnosed once, and again only where it changed."""
