# All rules of a study. The Snakefile that includes this file says what is made by default, as Snakemake takes no
# default from an included file.
include: "common.smk"
include: "run.smk"
include: "aggregate.smk"
include: "map.smk"
include: "atlas.smk"
include: "notebook.smk"
include: "page.smk"
include: "plan.smk"
