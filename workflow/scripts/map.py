from granstudy.dataset import read_dataset
from granstudy.figures import save_figure
from granstudy.label_map import label_map, write_map
from granstudy.label_map_figure import draw_map

tables = dict(zip(snakemake.params.cases, map(read_dataset, snakemake.input), strict=True))
table = label_map(snakemake.params.title, tables)
write_map(table, snakemake.output.nc, snakemake.output.csv, snakemake.output.md)
save_figure(draw_map(table), snakemake.output.png, snakemake.output.svg)
