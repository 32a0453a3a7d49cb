"""Processes killed at random times: no damaged file under a final name; the next command goes on."""

import random
import time

from promises.trial import Trial, compute, damaged_names, digests, start

LONGEST = 2.5
"""Seconds after which a process is killed at the latest; the study takes about as long."""


def trial(seed, folder, reference):
    """Kill a study up to three times, finish it, and compare with one that was left alone."""
    draw = random.Random(seed)
    kills = draw.randint(1, 3)
    hit = 0
    for _ in range(kills):
        process = start(compute, folder)
        time.sleep(draw.uniform(0.0, LONGEST))
        hit += process.is_alive()
        process.kill()
        process.join()
        if damaged := damaged_names(folder):
            return Trial(False, f"damaged under a final name: {damaged[0]}")
    found = digests(folder)
    if not found.items() <= digests(reference).items():
        return Trial(False, "a run that differs from the undisturbed one")
    finish = start(compute, folder)
    finish.join(120)
    if finish.exitcode != 0:
        return Trial(False, f"the next command ended with {finish.exitcode}")
    if digests(folder) != digests(reference):
        return Trial(False, "finished with other bytes")
    return Trial(True, f"killed {hit} times, finished with the same bytes")
