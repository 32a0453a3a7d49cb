from granstudy.study.execute import execute_job
from granstudy.study.study import load_study

study = load_study(snakemake.params.study)
execute_job(
    [study.run(snakemake.params.experiment, point) for point in snakemake.params.points],
    snakemake.params.run_keys,
    snakemake.output,
    snakemake.threads,
    snakemake.params.unfinished,
)
