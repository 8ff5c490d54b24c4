"""The compiled batch simulator, generated from the effects' laws and cached on disk."""

from affine_model.kernel.load import BLOCK, FEW, advance_blocks, load_kernel

__all__ = ["BLOCK", "FEW", "advance_blocks", "load_kernel"]
