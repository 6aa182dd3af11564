"""``python -m thermogear`` is the command line."""

from thermogear.front.cli import main

if __name__ == "__main__":
    main()
