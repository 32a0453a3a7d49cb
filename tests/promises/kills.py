"""Processes killed at random times: no damaged file under a final name; the next command goes on."""

import random
import time

from promises.trial import Trial, compute, start, unfinished, unsound

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
        if wrong := unsound(folder, reference):
            return Trial(False, wrong)
    if wrong := unfinished(folder, reference):
        return Trial(False, wrong)
    return Trial(True, f"killed {hit} times, finished with the same bytes")
