from granstudy.analysis.figures.figure import save_figure
from granstudy.analysis.figures.map import draw_map
from granstudy.analysis.tables.map import label_map, write_map
from granstudy.datasets.netcdf import read_dataset
from granstudy.support.log import log_to

log_to(snakemake.log[0])

tables = dict(zip(snakemake.params.cases, map(read_dataset, snakemake.input), strict=True))
table = label_map(snakemake.params.title, tables)
write_map(table, snakemake.output.nc, snakemake.output.csv, snakemake.output.md)
save_figure(draw_map(table), snakemake.output.png, snakemake.output.svg)
