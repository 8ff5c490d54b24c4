"""The command `tentacle`, and python -m tentacle."""

import signal
import sys

from tentacle.compiled_modules import remove_torn_modules, torn_module, write_no_torn_modules
from tentacle.limited_memory import memory_is_limited, watched_child
from tentacle.standard_streams import open_standard_streams


def main() -> int:
    """The exit code. Before the command line handles signals, Ctrl-C ends the program without a message."""
    open_standard_streams()
    write_no_torn_modules()
    if memory_is_limited() and (code := watched_child()) is not None:
        return code
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        from tentacle import cli
    except (EOFError, ValueError, TypeError) as error:  # what a torn one raises
        torn = torn_module(error)
        if torn is None:
            raise
        print(f"tentacle: {remove_torn_modules(torn)}", file=sys.stderr)
        return 2
    return cli.main()


if __name__ == "__main__":
    sys.exit(main())
