# The analysis a user would do, executed on the study's real datasets.
# Notebooks that need no results: `snakemake notebooks`. Not part of `all`.
EXAMPLES = glob_wildcards("notebooks/{name,[0-9]_[^/]+}.ipynb").name


rule notebooks:
    input:
        expand(f"{RESULTS}/notebooks/{{name}}.ipynb", name=EXAMPLES),


rule notebook:
    input:
        notebook="notebooks/{name}.ipynb",
        runs=lambda wildcards: LAYOUT.notebook_files(wildcards.name),
    output:
        f"{RESULTS}/notebooks/{{name}}.ipynb",
    log:
        f"{RESULTS}/logs/notebooks/{{name}}.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        results=lambda wildcards, output: str(Path(output[0]).parents[1]),
    message:
        "notebook {wildcards.name}"
    script:
        "../scripts/notebook.py"
