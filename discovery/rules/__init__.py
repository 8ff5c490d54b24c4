"""The loop decided by tests with limits: score test, refits, gates. It diagnoses free decays (discovery.diagnose)."""
