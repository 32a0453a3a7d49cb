from granstudy.analysis.tables.plan import write_plan
from granstudy.study.study import read_study
from granstudy.support.log import log_to

log_to(snakemake.log[0])

write_plan(read_study(snakemake.input.study), *snakemake.output)
