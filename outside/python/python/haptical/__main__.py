"""The command `haptical`: also `python -m haptical`."""

import sys

from . import _haptical


def main() -> None:
    """Run the words of the command line, and exit with the command's status."""
    sys.exit(_haptical.command(["haptical", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
