from granstudy.execute import execute
from granstudy.study import load_study

run = load_study(snakemake.params.study).run(
    snakemake.wildcards.experiment, snakemake.wildcards.point
)
execute(run, snakemake.output[0], threads=snakemake.threads)
