# Studies of granular gases. `snakemake --cores 2` regenerates the paper; another study by
# `snakemake --cores 2 --config study=my_study.yaml`.
from importlib.resources import files

config.setdefault("study", "studies/paper.yaml")


include: str(files("granstudy") / "workflow" / "rules" / "study.smk")


rule all:
    default_target: True
    input:
        LAYOUT.wanted,
