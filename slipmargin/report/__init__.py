"""Words, tables and pages that the front door and the figures share; nothing here draws."""
