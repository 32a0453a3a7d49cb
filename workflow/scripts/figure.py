from granstudy.dataset import read_dataset
from granstudy.figures import draw, save_figure
from granstudy.study import load_study

experiment = load_study(snakemake.params.study).model.experiments[snakemake.wildcards.experiment]
figure = draw(
    experiment,
    read_dataset(snakemake.input.table),
    snakemake.input.runs,
    [read_dataset(table) for table in snakemake.input.beside],
)
save_figure(figure, *snakemake.output)
