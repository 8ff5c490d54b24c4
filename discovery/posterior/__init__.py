"""The loop decided by posterior mass under one likelihood (inference.latent_force)."""
