"""A run as a labelled xarray dataset and a NetCDF file, and many runs opened as one."""
