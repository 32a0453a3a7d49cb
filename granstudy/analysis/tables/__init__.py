"""Tables of an experiment's runs, the map of a study and its plan, as NetCDF, CSV and Markdown."""
