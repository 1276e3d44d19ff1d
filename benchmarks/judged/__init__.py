"""Measured data sets with an effect that their robot file does not declare, to test ``slipmargin diagnose``.

Nothing here imports the package that is tested, except the scripts that call its command line.
"""
