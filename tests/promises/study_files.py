"""Study files with random mistakes: planned whole, or refused by lines of ours, before any work."""

import warnings

from study_mutations import OWN_CODE, mutated

from granstudy.analysis.requests import check_requests
from granstudy.study.jobs import jobs
from granstudy.study.study import load_study
from promises.trial import Trial


def trial(seed, folder, reference):
    """Load a study with a few random mistakes, and plan it."""
    (folder / "my_gas.py").write_text(OWN_CODE)
    (folder / "nodes.txt").write_text("1 0 0\n-1 0 0\n")
    path = folder / "random.yaml"
    path.write_bytes(mutated(seed).encode("utf-8", "surrogatepass"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)
        try:
            study = load_study(path)
            check_requests(study, path)
        except ValueError as error:
            lines = str(error).splitlines()
            ours = type(error) is ValueError and all(line.startswith(str(path)) for line in lines)
            return Trial(ours, "refused" if ours else f"an error of another kind: {error!r:.80}")
        except Exception as error:
            return Trial(False, f"an error of another kind: {type(error).__name__}")
        jobs([[member] for member in study.members], 2)
    return Trial(True, "planned")
