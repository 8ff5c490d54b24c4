"""The argument `--device` of the commands that fit recordings."""

from __future__ import annotations

import argparse


def add_device(parser: argparse.ArgumentParser) -> None:
    """The option, with the words of `tentacle optimise`; affine_model.device.cuda_device reads them."""
    parser.add_argument(
        "--device", default="auto",
        help="cpu, cuda, cuda:1; auto (default): the CPU, because a fit's batches do not fill a GPU",
    )  # fmt: skip
