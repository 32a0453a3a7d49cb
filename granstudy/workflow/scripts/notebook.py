from granstudy.analysis.notebook import execute_notebook
from granstudy.support.log import log_to

log_to(snakemake.log[0])

execute_notebook(snakemake.input.notebook, snakemake.output[0], snakemake.params.results)
