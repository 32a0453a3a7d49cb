from granstudy.datasets.collected import gather
from granstudy.study.healing import healed
from granstudy.study.layout import Layout
from granstudy.study.study import read_study
from granstudy.support.files import read_json
from granstudy.support.log import log_to

log_to(snakemake.log[0])
layout = Layout(read_study(snakemake.params.study), snakemake.params.results)
keys = read_json(snakemake.input[0])
name = snakemake.wildcards.experiment
with healed(layout, name):
    gather({key: layout.run_file(name, path) for path, key in keys.items()}, snakemake.output[0])
