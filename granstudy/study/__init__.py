"""From a study file to its runs, their keys and jobs, and where their results lie."""
