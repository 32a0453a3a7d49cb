from granstudy.datasets.netcdf import write_dataset
from granstudy.datasets.open_runs import open_runs
from granstudy.study.layout import Layout
from granstudy.study.study import read_study
from granstudy.support.log import log_to

log_to(snakemake.log[0])

layout = Layout(read_study(snakemake.params.study), snakemake.params.results)
runs = open_runs(layout.run_files(snakemake.wildcards.experiment), densities=False)
write_dataset(runs.load(scheduler="synchronous"), snakemake.output[0], sidecar=False)
