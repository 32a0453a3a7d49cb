from granstudy.datasets.collected import gather
from granstudy.study.layout import Layout
from granstudy.study.study import read_study
from granstudy.support.files import read_json
from granstudy.support.log import log_to

log_to(snakemake.log[0])
layout = Layout(read_study(snakemake.params.study), snakemake.params.results)
keys = read_json(snakemake.input[0])
name = snakemake.wildcards.experiment
damaged = layout.store.heal(keys.values())
if damaged:
    raise ValueError(
        f"{len(damaged)} runs were damaged and are removed; the same command computes them anew"
    )
gather({key: layout.run_file(name, path) for path, key in keys.items()}, snakemake.output[0])
