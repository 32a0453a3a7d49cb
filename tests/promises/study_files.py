"""Study files with random mistakes: planned whole, or refused by lines of ours, before any work."""

from study_mutations import mutated, verdict

from promises.trial import Trial


def trial(seed, folder, reference):
    """Load a study with a few random mistakes, and plan it."""
    try:
        said = verdict(mutated(seed), folder)
    except Exception as error:
        return Trial(False, f"an error of another kind: {error!r:.80}")
    return Trial(True, "refused" if said else "planned")
