from granstudy.plan_table import write_plan
from granstudy.study import load_study

write_plan(load_study(snakemake.input.study), *snakemake.output)
