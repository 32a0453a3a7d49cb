from granstudy.analysis.figures.atlas import draw_atlas
from granstudy.analysis.figures.figure import save_figure
from granstudy.analysis.tables.atlas import atlas_of, write_atlas
from granstudy.datasets.netcdf import read_dataset
from granstudy.support.log import log_to

log_to(snakemake.log[0])

atlas = atlas_of(snakemake.params.title, list(map(read_dataset, snakemake.input)))
write_atlas(atlas, snakemake.output.nc, snakemake.output.csv, snakemake.output.md)
save_figure(draw_atlas(atlas), snakemake.output.png, snakemake.output.svg)
