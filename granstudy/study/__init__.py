"""From a study file to checked runs, jobs and results."""
