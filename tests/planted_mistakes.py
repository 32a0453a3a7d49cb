# ruff: noqa: E501 (a row is a mistake)
"""A study of every kind of run, and mistakes planted in it: what is written, where, and what it is told."""

import re

from studies import replaced

STUDY = """title: planted
map: {title: Errors and labels}
experiments:
  cooling:
    title: "Cooling of hard spheres"
    run: evolution
    scene: {name: maxwellian3d, temperature: 1.0, exponent: 1.0, diffusion: 0.0}
    solver: {R: 7.0, method: radial}
    time: {t_final: 1.0, dt: 0.1}
    sweep:
      - {e: [0.2, 0.8], N: [8, 16]}
    table: {quantity: temperature}
    fit: {law: haff}
    figure: {kind: cooling}
  order:
    title: "Order in the step"
    run: evolution
    scene: {name: bkw2d, restitution: 0.2, diffusion: 1.0e-6}
    solver: {N: 8, R: 7.8, N_rho: 8, M_cir: 8}
    time: {t_final: 2.0}
    sweep:
      - {dt: [0.5, 0.25], variant: [full]}
    table: {quantity: temperature_error}
    fit: {law: order, x: dt}
    figure: {kind: convergence, x: dt}
  printed:
    title: "Table 1"
    run: evolution
    scene: {name: bkw2d, diffusion: 1.0e-6}
    solver: {R: 7.8, N_rho: 30, M_cir: 30}
    time: {t_final: 2.0, dt: 0.5}
    sweep:
      - {e: [0.2], N: [8, 16], variant: [full]}
    table: {quantity: paper_temperature_error, paper: table1}
  held:
    title: "Beside a law"
    run: evolution
    scene: {name: bkw3d, restitution: 0.2, diffusion: 0.0}
    solver: {N: 16, R: 9.0, method: radial}
    time: {t_final: 2.0}
    truth: {law: maxwell}
    sweep:
      - {dt: [0.5, 0.25]}
    table: {quantity: largest_temperature_error}
    figure: {kind: gallery}
  long:
    title: "Haff's law over decades"
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0}
    solver: {N: 16, R: 9.0, method: radial}
    time: {t_final: 100.0, time_rtol: 1.0e-4, frame: rescaled, times: {first: 0.1, per_decade: 5}}
    sweep:
      - {e: [0.2, 0.5]}
    table: {quantity: temperature}
    fit: {law: slope}
    figure: {kind: slope}
  particles:
    title: "Particles"
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0}
    solver: {N: 16, R: 8.0, method: dsmc, particles: 1000, batches: 10}
    time: {t_final: 4.0, time_rtol: 1.0e-4}
    sweep:
      - {e: [0.2, 0.5]}
    table: {quantity: a2, average: {start: 1.0}}
  errors:
    title: "Errors of Q"
    run: collision
    scene: {name: bkw3d, restitution: 0.2}
    solver: {N: 8, R: 7.0, N_rho: 8}
    reference: {method: direct, circular: true}
    sweep:
      - {M_sph: [6, 12], sphere_rule: design}
    table: {quantity: collision_error}
    figure: {kind: convergence, x: M_sph}
  timed:
    title: "Seconds"
    run: benchmark
    scene: {name: bkw3d, restitution: 0.2}
    solver: {R: 7.0, N_rho: 8, M_sph: 6}
    timing: {single_thread: false, memory: false}
    sweep:
      - {N: [8, 16], method: fast}
    table: {quantity: seconds}
    fit: {law: growth}
    figure: {kind: speed, x: N}
  front:
    title: "Front"
    run: benchmark
    scene: {name: bkw3d, restitution: 0.2}
    solver: {R: 7.0, N: 8}
    reference: {method: direct, N_rho: null}
    timing: {baseline: {method: literal, M_sph: 6}, single_thread: false, memory: false}
    sweep:
      - {method: [literal, fast], M_sph: [6, 12]}
    table: {quantity: seconds}
    figure: {kind: front}
  states:
    title: "Cooling states"
    run: state
    state: cooling
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0}
    solver: {N: 16, R: 9.0, method: radial}
    sweep:
      - {e: [0.2, 0.5]}
    table: {quantity: a2, beside: [particles]}
    figure: {kind: states}
"""


def planted(old, new):
    """The study with one thing in it changed, without most experiments that the change does not concern."""
    before, after = sections(STUDY), sections(replaced(STUDY, old, new))
    changed = [section for section in after if section not in before]
    beside = re.findall(r"beside: \[(\w+)\]", "".join(changed))
    kept = ("title", "held", *beside)
    return "".join(each for each in after if each in changed or each.split(":")[0].strip() in kept)


def sections(text):
    """A study's text cut before each experiment."""
    return re.split(r"^(?=  \S.*:$)", text, flags=re.MULTILINE)


NAMES = [
    (
        "  cooling:",
        "  ../x:",
        "experiments.'../x': is no name of an experiment; allowed are letters a",
    ),
    ("  cooling:", "  a/b:", "experiments.'a/b': is no name"),
    ("  cooling:", "  a\\b:", r"experiments.'a\\\\b': is no name"),
    ("  cooling:", "  '{x}':", "experiments.'{x}': is no name"),
    ("  cooling:", "  '':", "experiments.'': is no name"),
    ("  cooling:", "  .hidden:", "experiments.'.hidden': is no name"),
    ("  cooling:", "  a b:", "experiments.'a b': is no name"),
    ("  cooling:", "  it's:", "is no name"),
    ("  cooling:", f"  {'x' * 65}:", "64 at most"),
    (
        "  cooling:",
        "  reference:",
        "experiments.'reference': is taken, as are map, atlas, reference",
    ),
    ("  cooling:", "  map:", "experiments.'map': is taken"),
    ("  cooling:", "  atlas:", "experiments.'atlas': is taken"),
    ("  cooling:", "  HELD:", "experiments.'held': is 'HELD' but for capitals"),
    ("  cooling:", "  held:", "line \\d+: key 'held': is given twice, first in line 4"),
]

VALUES = [
    ("N: [8, 16]}", "N: [8, 16], R: [1e1]}", "cooling.sweep.R: value '1e1': must be a number .YAML reads 1e1"),
    ("N: [8, 16]}", "N: [8, 16], exponent: [1e-1]}", "sweep.exponent: value '1e-1': .*write 1.0e-1"),
    ("N: [8, 16]}", "N: [8, 16], conserve: [no]}", "sweep.conserve: value False: must be a text .YAML reads yes"),
    ("N: [8, 16]}", "N: [8, 16], frame: 5}", "sweep.frame: value 5: must be a text"),
    ("e: [0.2, 0.8]", "e: []", "sweep.e: is empty; give at least one value"),
    ("e: [0.2, 0.8]", "e: [null]", "sweep.e: value None: must be a number"),
    ("e: [0.2, 0.8]", "e: [[0.2]]", r"sweep.e: value \[0.2\]: must be a number"),
    ("e: [0.2, 0.8]", "e: [0.2, yes]", "sweep.e: value True: must be a number"),
    ("e: [0.2, 0.8]", "e: [0.2, 1.8]", "run e~1.8/N~8: e=1.8: must be a number between 0 and 1"),
    ("e: [0.2, 0.8]", "e: {start: 0.1, stop: 0.9}", "sweep.e: count, step: give one"),
    ("e: [0.2, 0.8]", "e: {start: 0.1, stp: 0.9}", "sweep.e.stp: unknown field of a range .did you mean 'stop'"),
    ("e: [0.2, 0.8]", "e: {start: 0.1, stop: 0.9, count: 5000000}", "sweep.e: count, step: more than 100,000 v"),
    ("e: [0.2, 0.8]", "e: {start: 0.1, stop: 0.9, step: 1.0e-12}", "sweep.e: count, step: more than 100,000 v"),
    ("e: [0.2, 0.8]", "e: {start: 0.1, stop: 0.9, count: 9.5}", "sweep.e.count: value 9.5: must be a whole nu"),
    ("N: [8, 16]}", "N: {start: 8.0, stop: 16.0, count: 2}}", "sweep.N: value 8.0: must be a whole number .write 8"),
    (
        "e: [0.2, 0.8], N: [8, 16]",
        "e: {start: 0.1, stop: 0.9, count: 1000}, N: [8, 16], temperature: {start: 1.0, stop: 2.0, count: 900}",
        "cooling.sweep: has 1800000 runs .1000 e × 2 N × 900 temperature.; must be 100000 at most",
    ),
    ("sphere_rule: design", "sphere_rule: [5]", "sweep.sphere_rule: value 5: must be a text"),
    ("M_sph: [6, 12], s", "M_sph: [100000, 100000], s", "M_sph=100000: "),
    ("M_sph: [6, 12], s", "M_sph: [[100000, 100000]], s", r"M_sph=.100000, 100000.: must be 100,000 at most"),
    ("dt: [0.5, 0.25], v", "dt: [1.0e-300], v", "dt=1e-300: t_final=2.0 would take more than 100,000,000 steps"),
    ("t_final: 2.0}\n    sweep:\n      - {dt: [0.5, 0.25], v", "t_final: 1.0e+12}\n    sweep:\n      - {dt: [0.5], v", "dt=0.5: t_final=1000000000000.0 would take"),
    ("per_decade: 5", "per_decade: 10000000", "times.per_decade=10000000: makes 30000001 outputs; must be 100,000"),
    ("first: 0.1", "first: 200.0", "times.first=200.0: must be below the last time, 100.0"),
    ("N_rho: 8, M_cir: 8", "N_rho: 8, M_cir: 1.0e8", "order.solver.M_cir: value '1.0e8': must be a whole number .*write 100000000"),
    ("N_rho: 8, M_cir: 8", "N_rho: 8, M_cir: 100000000", "M_cir=100000000: must be 100,000 at most"),
    ("N_rho: 8, M_cir: 8", "N_rho: 100000000, M_cir: 8", "N_rho=100000000: must be 10,000 at most"),
    ("solver: {N: 8, R: 7.8", "solver: {N: 1000000, R: 7.8", "N=1000000: must be 100,000 at most"),
    ("solver: {N: 8, R: 7.8", "solver: {N: 60000, R: 7.8", "N=60000, method='fast': the run would take .* GB; this machine has"),
    ("{N: 16, R: 8.0, method: dsmc", "{N: 4000, R: 8.0, method: dsmc", "N=4000, method='dsmc': the run would take .* GB"),
    ("particles: 1000,", "particles: 1000000000000,", "the run would take .* GB"),
    ("particles: 1000,", "particles: 10000000000000000,", "particles=10000000000000000: must be 10,000,000,000,000 at most"),
    ("t_final: 1.0, dt: 0.1", "t_final: 1.0, dt: 1e-1", "cooling.time.dt: value '1e-1': must be a number .*write 1.0e-1"),
    ("t_final: 1.0, dt: 0.1", "t_final: 1.0, dt: 0.3", "dt=0.3: t_final=1.0 must be a whole number of steps"),
    ("t_final: 1.0, dt: 0.1", "t_final: 1.0, dt: .nan", "value .nan: must be a finite number"),
    ("frame: rescaled", "frame: [rescaled]", r"long.time.frame: value \['rescaled'\]: must be a text"),
    ("truth: {law: maxwell}", "truth: {law: maxwel}", "held.truth.law: value 'maxwel': must be 'maxwell'"),
    ("truth: {law: maxwell}", "truth: {solver: {N: 8, R: 7.0, method: fats}, time: {dt: 0.5}}", "truth: unknown method 'fats'"),
    ("restitution: 0.2, diffusion: 0.0", "restitution: 0.2, exponent: 1.0, diffusion: 0.0", "truth.law='maxwell': holds at exponent 0, not at 1.0"),
    ("restitution: 0.2, diffusion: 0.0", "restitution: [0.2], diffusion: 0.0", r"held.scene.restitution: value \[0.2\]: must be a number or a text or a section of viscoelastic"),
    ("restitution: 0.2, diffusion: 0.0", "restitution: {viscoelastc: 0.2}, diffusion: 0.0", "restitution.viscoelastc: unknown field .did you mean 'viscoelastic'"),
    ("reference: {method: direct, circular: true}", "reference: {method: direct, N: 16}", "N=8: the reference has N=16; .* leave N out of the reference"),
    ("reference: {method: direct, circular: true}", "reference: {method: direct, R: 6.0}", "R=7.0: the reference has R=6.0"),
    ("reference: {method: direct, circular: true}", "reference: {method: radial, circular: true}", "method 'fast': has other velocity nodes than its reference's method 'radial'"),
    ("reference: {method: direct, circular: true}", "reference: {method: dsmc}", "errors"),
    ("baseline: {method: literal, M_sph: 6}", "baseline: {method: literal, M_sph: 7}", "front.timing.baseline: .* values of 0 runs"),
    ("{name: maxwellian3d, temperature: 1.0", "{name: maxwellian3d, temprature: 1.0", "scene.temprature: unknown field .did you mean 'temperature'"),
    ("{name: maxwellian3d, temperature: 1.0", "{name: my_gas.py:two, temperature: 1.0", "there is no file"),
    ("title: planted\n", "title: 5\n", "title: value 5: must be a text"),
    ("title: planted\n", "", "title: must be given"),
    ("map: {title: Errors and labels}", "map: 5", "map: value 5: must be a section of title"),
    ("    sweep:\n      - {e: [0.2, 0.8], N: [8, 16]}\n", "    sweep: 5\n", "cooling.sweep: value 5: must be a list of blocks"),
    ("      - {e: [0.2, 0.8], N: [8, 16]}\n", "      - {e: [0.2], N: 8}\n      - {e: [0.5]}\n", "all blocks must set the same parameters"),
]  # fmt: skip

REQUESTS = [
    ("quantity: temperature}\n    fit: {law: haff}", "quantity: temprature}\n    fit: {law: haff}", "cooling.table.quantity: unknown quantity 'temprature' .did you mean 'temperature'"),
    ("quantity: temperature}\n    fit: {law: haff}", "quantity: temperature_error}\n    fit: {law: haff}", "cooling.table.quantity='temperature_error': only Maxwell molecules .exponent 0. with constant e have it"),
    ("quantity: temperature}\n    fit: {law: haff}", "quantity: velocity_scale}\n    fit: {law: haff}", "table.quantity='velocity_scale': only runs with frame rescaled have it"),
    ("quantity: temperature}\n    fit: {law: haff}", "quantity: a2_standard_error}\n    fit: {law: haff}", "only runs of method dsmc have it"),
    ("quantity: temperature}\n    fit: {law: haff}", "quantity: largest_a2_error}\n    fit: {law: haff}", "unknown quantity 'largest_a2_error'"),
    ("quantity: temperature}\n    fit: {law: haff}", "quantity: trust}\n    fit: {law: haff}", "unknown quantity 'trust'"),
    ("quantity: temperature}\n    fit: {law: slope}", "quantity: step_ratio}\n    fit: {law: slope}", "only runs on a grid with dt have it"),
    ("quantity: collision_error", "quantity: seconds", "errors.table.quantity: unknown quantity 'seconds'.*allowed are collision_error, relative_error"),
    ("quantity: seconds}\n    fit: {law: growth}", "quantity: error}\n    fit: {law: growth}", "timed.table.quantity: unknown quantity 'error'"),
    ("quantity: largest_temperature_error", "quantity: energy", "held.table.quantity: unknown quantity 'energy'"),
    ("quantity: largest_temperature_error", "quantity: seconds", "held.table.quantity: unknown quantity 'seconds'"),
    ("quantity: a2, beside: [particles]", "quantity: a2_exact, beside: [particles]", "states.table.quantity: unknown quantity 'a2_exact'"),
    ("paper: table1", "paper: table9", "printed.table.paper: unknown printed table 'table9' .did you mean"),
    ("paper: table1", "paper: table3", "printed.table.paper='table3': is printed by M_sph, which the runs do not have"),
    ("paper: table1", "paper: figure4", "printed.table.paper='figure4': prints C0, which the table does not have"),
    ("e: [0.2], N: [8, 16], variant", "e: [0.3], N: [8, 16], variant", "table.paper='table1': prints no number for any of the runs"),
    ("average: {start: 1.0}", "average: {start: 9.0}", "particles.table.average.start=9.0: must be t_final=4.0 at most"),
    ("average: {start: 1.0}", "average: {start: 1.0, of: [a3]}", "table.average.of: unknown moment 'a3'.*allowed are temperature, a2"),
    ("quantity: temperature}\n    fit: {law: haff}", "quantity: temperature, average: {start: 0.5}}\n    fit: {law: haff}", "cooling.table.average: only method 'dsmc' has it, not e~0.2"),
    ("quantity: largest_temperature_error", "quantity: largest_temperature_error, average: {start: 0.5}", "held.table.average: not beside a truth"),
    ("law: haff", "law: haf", "cooling.fit.law: unknown law 'haf' .did you mean 'haff'"),
    ("exponent: 1.0, diffusion: 0.0}\n    solver: {R: 7.0", "exponent: 0.0, diffusion: 0.0}\n    solver: {R: 7.0", "cooling.fit.law='haff': Haff's law holds for exponent > 0"),
    ("exponent: 1.0, diffusion: 0.0}\n    solver: {R: 7.0", "exponent: 1.0, diffusion: 0.1}\n    solver: {R: 7.0", "cooling.fit.law='haff': Haff's law holds without heating; run e~0.2/N~8 has diffusion 0.1"),
    ("t_final: 1.0, dt: 0.1", "t_final: 1.0, dt: 1.0", "cooling.fit.law='haff': needs three outputs or more; run e~0.2/N~8 has 2"),
    ("times: {first: 0.1, per_decade: 5}", "times: [50.0]", "long.fit.law='slope': is of the last decade of t; the first output"),
    ("law: growth", "law: haff", "timed.fit.law='haff': is of T.t. of evolution runs, not of benchmark runs"),
    ("law: haff", "law: growth", "cooling.fit.law='growth': is of seconds of benchmark runs, not of evolution runs"),
    ("N: [8, 16], method: fast", "N: 8, method: fast", "timed.fit.law='growth': needs two values of N of a method"),
    ("law: haff", "law: haff, x: e", "cooling.fit.x='e': only law 'order' takes it"),
    ("x: dt}\n    figure", "x: Q}\n    figure", "order.fit.x='Q': must be one of the swept parameters variant, dt"),
    ("{law: order, x: dt}", "{law: order}", "order.fit.x: must be given"),
    ("x: dt}\n    figure", "x: variant}\n    figure", "order.fit.x='variant': must have positive numbers, not full"),
    ("dt: [0.5, 0.25], v", "dt: [0.5], v", "order.fit.x='dt': has one value at variant=full; an order needs two"),
    ("quantity: temperature_error}\n    fit", "quantity: temperature}\n    fit", "order.fit.law='order': is of an error that falls with dt, not of table.quantity='temperature'"),
    ("kind: cooling", "kind: coling", "cooling.figure.kind: unknown kind 'coling' .did you mean 'cooling'"),
    ("kind: cooling", "kind: gallery", "cooling.figure.kind='gallery': shows runs beside their truth; give one"),
    ("kind: cooling", "kind: speed", "cooling.figure.kind='speed': shows seconds of benchmark runs, not of evolution"),
    ("kind: cooling", "kind: front", "cooling.figure: Cooling of hard spheres: has no errors; a front needs a bench"),
    ("kind: cooling", "kind: states", "cooling.figure: Cooling of hard spheres: is no table of states swept over e"),
    ("kind: cooling", "kind: convergence", "cooling.figure.x: must be given"),
    ("kind: cooling", "kind: convergence, x: e", "cooling.figure.x='e': has a panel for each value"),
    ("kind: cooling", "kind: cooling, x: e", "cooling.figure.x='e': only convergence, speed, quantity, map take it, not cooling"),
    ("kind: cooling", "kind: cooling, beside: [held]", r"cooling.figure.beside=\['held'\]: only front, states take it"),
    ("kind: convergence, x: dt", "kind: convergence, x: Q", "order.figure.x='Q': must be one of the swept parameters"),
    ("kind: convergence, x: M_sph", "kind: cooling", "errors.figure.kind='cooling': shows T.t. of evolution runs, not of collision"),
    ("kind: speed, x: N", "kind: front", "timed.figure: Seconds: has no errors"),
    ("kind: speed, x: N", "kind: speed, x: M_sph", "timed.figure.x='M_sph': a speed figure is drawn over N"),
    ("timing: {baseline: {method: literal, M_sph: 6}, single_thread: false, memory: false}\n    sweep:\n      - {method: [literal, fast]", "timing: {single_thread: false}\n    sweep:\n      - {method: [fast]", "front.figure: Front: has 0 baselines; a front needs one"),
    ("kind: gallery", "kind: front", "held.figure: Beside a law: a front needs table.seconds: true"),
    ("kind: slope", "kind: slope, title: '$\\foo$'", "long.figure.title: value .*: between . and . stands mathematics that Matplotlib"),
    ("Cooling of hard spheres", "Cooling of $\\\\foo$", "cooling.title: value .*Matplotlib cannot read"),
    ("- {e: [0.2, 0.5]}\n    table: {quantity: temperature}\n    fit: {law: slope}", "- {N: [8, 16], e: 0.5, exponent: [0.5, 1.0]}\n    table: {quantity: temperature}\n    fit: {law: slope}", "long.figure.kind='slope': shows one exponent"),
    ("kind: states", "kind: states, beside: [cooling]", "states.figure: Cooling of hard spheres: is no table of states"),
    ("kind: states", "kind: states, beside: [nothing]", "states.figure.beside: unknown experiment 'nothing'"),
    ("kind: states", "kind: states, beside: [states]", "states.figure.beside: 'states' is the experiment itself"),
    ("beside: [particles]", "beside: [held]", "states.table.beside='held': sweeps none of e"),
    ("beside: [particles]", "beside: [cooling]", "states.table.beside='cooling': its table has no a2; give it quantity: a2"),
    ("beside: [particles]", "beside: [states]", "states.table.beside: 'states' is the experiment itself"),
    ("beside: [particles]", "beside: [partices]", "states.table.beside: unknown experiment 'partices': allowed are"),
]  # fmt: skip
