"""The command `tentacle`, and python -m tentacle."""

import signal
import sys


def main() -> int:
    """The exit code. Before the command line handles signals, Ctrl-C ends the program without a message."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from tentacle import cli

    return cli.main()


if __name__ == "__main__":
    sys.exit(main())
