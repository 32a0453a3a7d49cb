"""Random runs beside their truths: what labels and estimates are worth."""
