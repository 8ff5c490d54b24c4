"""The loop that decides by tests with limits: score test, refits, gates. It diagnoses free decays."""
