from granstudy.datasets.netcdf import write_dataset
from granstudy.study.benchmark.benchmark import benchmark
from granstudy.study.study import read_study
from granstudy.support.log import log_to

log_to(snakemake.log[0])

study = read_study(snakemake.params.study)
runs = list(study.runs[snakemake.wildcards.experiment].values())
write_dataset(benchmark(runs, snakemake.threads), snakemake.output[0])
