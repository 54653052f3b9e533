"""python -m pdepth is the command pdepth."""

from ._command import main

main()
