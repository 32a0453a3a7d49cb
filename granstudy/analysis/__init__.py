"""What people read of a study: tables, figures, comparisons."""
