"""How far to believe a run: exact laws, estimated errors, signs of health, labels."""
