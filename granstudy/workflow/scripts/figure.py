from granstudy.analysis.figures.figure import draw, save_figure
from granstudy.datasets.netcdf import read_dataset
from granstudy.study.healing import healed
from granstudy.study.layout import Layout
from granstudy.study.study import read_study
from granstudy.support.log import log_to

log_to(snakemake.log[0])

study = read_study(snakemake.params.study)
name = snakemake.wildcards.experiment
layout = Layout(study, snakemake.params.results)
with healed(layout, name):
    figure = draw(
        study.model.experiments[name],
        read_dataset(snakemake.input.table),
        layout.run_files(name),
        [read_dataset(table) for table in snakemake.input.beside],
        study.runs[name],
    )
save_figure(figure, *snakemake.output)
