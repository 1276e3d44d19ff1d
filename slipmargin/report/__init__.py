"""Words and tables that the command line, the figures and the pages share."""
