"""Tables and figures of a study, beside the paper's numbers; comparison with committed tables."""
