"""`python -m nxt_twin`: the program, where its script is not on the path."""

from nxt_twin.cli import main

main()
