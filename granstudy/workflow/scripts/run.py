from granstudy.study.jobs import Job
from granstudy.study.layout import Layout
from granstudy.study.study import read_study
from granstudy.study.work import work
from granstudy.support.log import log_to

log_to(snakemake.log[0])

job = Job.read(snakemake.params.job)
layout = Layout(read_study(snakemake.params.study), snakemake.params.results)
work(job, layout, snakemake.threads, snakemake.output.receipt)
