"""Stands in for evalio, which is not in Debian: the names that a pipeline meets (version 0.5.0)."""
