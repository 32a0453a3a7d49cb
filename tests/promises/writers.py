"""Several processes that compute one study at once: each run is computed once, and all of them see it."""

import random

from promises.trial import Trial, compute, damaged_names, digests, start, study


def trial(seed, folder, reference):
    """Start two to four processes at random moments, of which one may be killed."""
    draw = random.Random(seed)
    count = draw.randint(2, 4)
    processes = []
    for _ in range(count):
        processes.append(start(compute, folder))
        processes[-1].join(draw.uniform(0.0, 0.3))
    killed = draw.random() < 0.5
    if killed:
        processes[0].join(draw.uniform(0.0, 2.0))
        processes[0].kill()
    for process in processes:
        process.join(120)
    ends = [process.exitcode for process in processes[killed:]]
    if any(ends):
        return Trial(False, f"processes ended with {ends}")
    if damaged := damaged_names(folder):
        return Trial(False, f"damaged under a final name: {damaged[0]}")
    if digests(folder) != digests(reference):
        return Trial(False, "other bytes than by one process")
    if set(study(folder).runs["state"]) != {"done"}:
        return Trial(False, "runs are missing")
    return Trial(True, f"{count} processes{', one killed,' * killed} made the same bytes")
