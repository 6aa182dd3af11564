"""``python -m thermogear`` is the command line."""

import sys

from thermogear.front.entry import main

if __name__ == "__main__":
    sys.exit(main())
