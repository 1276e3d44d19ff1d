"""The front door's rooms: one file for each public function of :mod:`slipmargin`, with its result."""
