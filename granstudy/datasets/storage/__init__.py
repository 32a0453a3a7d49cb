"""How files of datasets hold what they hold: their format, their checksums, those of earlier versions."""
