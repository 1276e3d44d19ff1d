"""The command line: parses, calls the package, renders.  One command a file."""
