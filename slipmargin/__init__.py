"""How hard a wheeled omnidirectional robot can push, turn and accelerate before a wheel slips.

The package is silent: it opens no window, prints nothing and reads no file outside
:mod:`slipmargin.io`.  Heavy libraries are imported only in the room that owns them.
"""

__version__ = "0.1.0"
