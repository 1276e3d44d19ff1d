"""Which runs to drive next: a library of motions, timed inside the limits, and what each would tell."""
