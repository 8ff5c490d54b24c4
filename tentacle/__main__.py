"""The command `tentacle`, and python -m tentacle."""

import signal
import sys


def main() -> int:
    """The exit code. Until the command line takes signals over, Ctrl-C ends this as it ends any program: in silence."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from tentacle import cli

    return cli.main()


if __name__ == "__main__":
    sys.exit(main())
