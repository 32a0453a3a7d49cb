from granstudy.analysis.tables.plan import write_plan
from granstudy.study.study import load_study

write_plan(load_study(snakemake.input.study), *snakemake.output)
