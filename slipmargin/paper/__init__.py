"""The paper reproduced: its runs, its numbers and the search for what it does not print."""
