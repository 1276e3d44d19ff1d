"""Foreign logs into records: one file a format, one small interface (:mod:`.plug`)."""
