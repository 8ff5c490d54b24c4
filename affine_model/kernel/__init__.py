"""The compiled batch simulator, generated from the effects' laws and cached on disk."""

from affine_model.kernel.load import BLOCK, advance_blocks, load_kernel

__all__ = ["BLOCK", "advance_blocks", "load_kernel"]
