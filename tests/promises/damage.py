"""Files of runs that are damaged, cut, exchanged or lost: never taken for results, computed anew."""

import random
import shutil

import granstudy as gs
from promises.trial import Trial, compute, digests, start, study


def trial(seed, folder, reference):
    """Damage some runs of a finished study in one way; readers must notice, and the next command heal."""
    draw = random.Random(seed)
    how = draw.choice(sorted(WAYS))
    shutil.copytree(reference / "results", folder / "results")
    files = sorted((folder / "results/.runs").glob("??/*.nc"))
    victims = draw.sample(files, draw.randint(1, 3))
    for file in victims:
        other = draw.choice([one for one in files if one != file])
        WAYS[how](file, draw, reference / other.relative_to(folder))
        if _is_believed(file, reference / file.relative_to(folder)):
            return Trial(False, f"{how}: read without a word")
    finish = start(compute, folder)
    finish.join(120)
    if finish.exitcode != 0:
        return Trial(False, f"{how}: the next command ended with {finish.exitcode}")
    if digests(folder) != digests(reference):
        return Trial(False, f"{how}: not healed")
    if not study(folder).dataset("cooling").identical(study(reference).dataset("cooling")):
        return Trial(False, f"{how}: another dataset of the experiment")
    return Trial(True, f"{how}: noticed, and computed anew")


def _is_believed(file, original):
    """Whether a file is read as the run of its name, with other content than it had."""
    try:
        ds = gs.read_dataset(file)
    except (OSError, ValueError):
        return False
    return ds.attrs["run_key"] == file.stem and not ds.identical(gs.read_dataset(original))


def _flip(file, draw, other):
    content = bytearray(file.read_bytes())
    content[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
    file.write_bytes(content)


def _blank(file, draw, other):
    content = bytearray(file.read_bytes())
    at = draw.randrange(len(content) - 512)
    content[at : at + 512] = bytes(512)
    file.write_bytes(content)


def _cut(file, draw, other):
    content = file.read_bytes()
    file.write_bytes(content[: draw.randrange(len(content))])


WAYS = {
    "a bit flipped": _flip,
    "512 bytes zeroed": _blank,
    "cut off": _cut,
    "another run's file": lambda file, draw, other: shutil.copy2(other, file),
    "another file": lambda file, draw, other: file.write_text("title: not a dataset"),
    "deleted": lambda file, draw, other: file.unlink(),
}
"""What is done to a file, given a source of random numbers and another run's file."""
