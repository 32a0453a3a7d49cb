from granstudy.analysis.tables.table import KINDS, experiment_table, write_table
from granstudy.datasets.netcdf import read_dataset
from granstudy.study.healing import healed
from granstudy.study.layout import Layout
from granstudy.study.study import read_study
from granstudy.support.log import log_to

log_to(snakemake.log[0])

study = read_study(snakemake.params.study)
name = snakemake.wildcards.experiment
experiment = study.model.experiments[name]
layout = Layout(study, snakemake.params.results)
with healed(layout, name):
    table = experiment_table(
        experiment,
        study.runs[name],
        layout.run_files(name),
        [read_dataset(table) for table in snakemake.input.beside],
    )
write_table(table, *snakemake.output, markdown=KINDS[experiment.run].markdown)
