# Studies of granular gases. `snakemake --cores 2` regenerates the paper; another study by
# `snakemake --cores 2 --config study=path/to/study.yaml`.


include: "workflow/rules/common.smk"
include: "workflow/rules/run.smk"
include: "workflow/rules/aggregate.smk"
include: "workflow/rules/map.smk"
include: "workflow/rules/notebook.smk"
include: "workflow/rules/plan.smk"


rule all:
    default_target: True
    input:
        LAYOUT.wanted,
