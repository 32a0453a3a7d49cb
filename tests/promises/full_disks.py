"""Disks that are full after some bytes: an error, no damaged file; with room again, the study goes on."""

import random
import subprocess

from promises.trial import Trial, compute, damaged_names, digests, start

LARGEST = 400_000
"""Bytes of the largest disk; the study takes about 350,000."""


def trial(seed, folder, reference):
    """Compute on a disk that is too small; give it room; compare with a study that was left alone."""
    size = random.Random(seed).randint(4096, LARGEST)
    disk = folder / "disk"
    disk.mkdir()
    _mount("-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(disk))
    try:
        process = start(compute, disk)
        process.join(120)
        full = process.exitcode != 0
        if damaged := damaged_names(disk):
            return Trial(False, f"damaged under a final name: {damaged[0]}")
        if not digests(disk).items() <= digests(reference).items():
            return Trial(False, "a run that differs from the undisturbed one")
        _mount("-o", "remount,size=64m", str(disk))
        finish = start(compute, disk)
        finish.join(120)
        if finish.exitcode != 0:
            return Trial(False, f"with room again the command ended with {finish.exitcode}")
        if digests(disk) != digests(reference):
            return Trial(False, "finished with other bytes")
    finally:
        subprocess.run(["umount", "-l", str(disk)], check=True)
    return Trial(True, "refused, then finished with the same bytes" if full else "there was room")


def can_mount(folder):
    """Whether this user may mount a disk in memory; root in most containers may."""
    try:
        _mount("-t", "tmpfs", "tmpfs", str(folder))
    except (OSError, subprocess.CalledProcessError):
        return False
    subprocess.run(["umount", str(folder)], check=True)
    return True


def _mount(*arguments):
    subprocess.run(["mount", *arguments], check=True, capture_output=True)
