"""The loop that decides by posterior mass under one likelihood (inference.latent_force)."""
