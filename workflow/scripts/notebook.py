from granstudy.analysis.notebook import execute_notebook

execute_notebook(snakemake.input.notebook, snakemake.output[0], snakemake.params.results)
