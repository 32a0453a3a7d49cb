from granstudy.analysis.tables.plan import write_plan
from granstudy.study.study import read_study

write_plan(read_study(snakemake.input.study), *snakemake.output)
