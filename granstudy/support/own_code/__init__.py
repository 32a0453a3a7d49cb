"""Functions of users: known by their content, loaded from their files, given their arguments."""
