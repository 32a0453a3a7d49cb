from granstudy.analysis.report.page import write_report
from granstudy.study.layout import Layout
from granstudy.study.study import read_study
from granstudy.support.log import log_to

log_to(snakemake.log[0])

layout = Layout(read_study(snakemake.input.study), snakemake.params.results)
write_report(layout, snakemake.input.study, snakemake.output.page, snakemake.params.tables)
