"""From "unknown" to a law: where the missing force acts, a search over a grammar of laws, proposals as effect files."""
