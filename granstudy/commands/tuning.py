"""`granstudy tune`: the fastest Fourier transforms of this machine, found once."""

import click

from granstudy.collision.fourier.tuning import LARGEST, shapes, tuning
from granstudy.collision.fourier.tuning import tune as found
from granstudy.collision.fourier.wisdom import kept, wisdom_path


@click.command()
@click.option(
    "--largest",
    type=click.IntRange(6),
    default=LARGEST[3],
    show_default=True,
    help="Most points per dimension of grids in 3D.",
)
@click.option("--anew", is_flag=True, help="Replace what an earlier call kept.")
def tune(largest: int, anew: bool) -> None:
    """Find the fastest Fourier transforms of this machine, once.

    FFTW times many ways to transform each size of grid and keeps the fastest in granstudy's cache folder, for
    all processes that start from then on. It takes minutes; let nothing else run meanwhile. Sizes that an
    earlier call found stay as they are. Results change in round-off, and stay valid.
    """
    ratios = []
    with tuning(anew) as texts:
        for precision in ("double", "single"):
            for gain in found(texts, shapes(largest), precision):
                click.echo(
                    f"{gain.name:<20} {1e6 * gain.estimate:10.1f} µs -> {1e6 * gain.patient:10.1f} µs   "
                    f"{gain.ratio:4.1f} times as fast"
                )
                ratios.append(gain.ratio)
    click.echo(
        f"{len(ratios)} of {len(texts)} sizes are new" if ratios else "all sizes were tuned before"
    )
    click.echo(f"{wisdom_path()}: wisdom {kept().digest}")
