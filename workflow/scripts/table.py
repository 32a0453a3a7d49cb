from granstudy.analysis.tables.table import experiment_table, write_table
from granstudy.datasets.netcdf import read_dataset
from granstudy.study.study import load_study

study = load_study(snakemake.params.study)
runs = study.runs[snakemake.wildcards.experiment]
table = experiment_table(
    study.model.experiments[snakemake.wildcards.experiment],
    runs,
    list(snakemake.input.runs),
    [read_dataset(table) for table in snakemake.input.beside],
)
write_table(table, *snakemake.output)
