"""A Slurm cluster of one node on this machine, without accounting.

``python tests/slurm_cluster.py COMMAND`` starts one, runs a command in it, and stops it.
"""

import contextlib
import os
import pwd
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import psutil

NEEDED = ("munged", "slurmctld", "slurmd", "srun", "setpriv")
START_SECONDS = 30.0
"""How long the node may take until it is idle."""

# MinJobAge is Slurm's own default; it is what lets squeue tell how a job ended.
SLURM_CONF = """
ClusterName=granstudy
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SlurmdParameters=config_overrides
PropagateResourceLimits=NONE
ReturnToService=2
MinJobAge=300
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory_mb} State=UNKNOWN
PartitionName=short Nodes=ALL Default=YES MaxTime=INFINITE State=UP
PartitionName=long Nodes=ALL MaxTime=INFINITE State=UP
"""


class CannotStartError(RuntimeError):
    """Slurm is not installed here, or one of its daemons does not come up."""


@dataclass(frozen=True)
class Job:
    """What squeue says of a job."""

    rule: str
    state: str
    partition: str
    cores: int
    memory_mb: int
    minutes: float


def _minutes(limit: str) -> float:
    """Minutes of a time limit under a day, written [hours:]minutes:seconds."""
    hours, minutes, seconds = ([0, 0] + [int(part) for part in limit.split(":")])[-3:]
    return 60 * hours + minutes + seconds / 60


@dataclass(frozen=True)
class Cluster:
    """A running cluster; its commands need `environment`."""

    folder: Path

    @property
    def environment(self) -> dict[str, str]:
        """This process's environment, and where the cluster's configuration lies."""
        path = [str(self.folder / "bin"), os.environ["PATH"], "/usr/sbin", "/sbin"]
        return os.environ | {
            "PATH": os.pathsep.join(path),
            "SLURM_CONF": str(self.folder / "slurm.conf"),
        }

    def ask(self, *command: str) -> str:
        """What a Slurm command prints."""
        return subprocess.run(
            command, env=self.environment, check=True, capture_output=True, text=True, timeout=60
        ).stdout

    def jobs(self) -> dict[str, Job]:
        """The jobs that the controller still knows, by number, the oldest first."""
        form = "%i %k %T %P %C %m %l"  # the plugin puts the rule into the comment, %k
        asked = ["squeue", "--states=all", "--noheader", "--sort=i", f"--format={form}"]
        jobs = {}
        for line in self.ask(*asked).splitlines():
            number, rule, state, partition, cores, memory, limit = line.split()
            jobs[number] = Job(
                rule, state, partition, int(cores), int(memory.rstrip("M")), _minutes(limit)
            )
        return jobs

    def pids(self, job: str) -> list[int]:
        """Processes of a running job on the node."""
        lines = self.ask("scontrol", "listpids", job).splitlines()[1:]
        return [int(pid) for pid in (line.split()[0] for line in lines) if int(pid) > 0]

    def processes(self) -> list[psutil.Process]:
        """All that runs in the cluster: daemons, who submits jobs, jobs, and the daemons of jobs."""
        # A job's daemon writes its title over its environment; it has a socket in the folder.
        sockets = psutil.net_connections("unix")
        listening = {each.pid for each in sockets if each.laddr.startswith(str(self.folder))}
        found = []
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error):
                conf = process.environ().get("SLURM_CONF")
                if conf == self.environment["SLURM_CONF"] or process.pid in listening:
                    found.append(process)
        return found


@contextlib.contextmanager
def slurm_cluster(cpus: int = 2, memory_mb: int = 8000) -> Iterator[Cluster]:
    """Start a cluster of one node, and stop it with all that runs in it.

    All that it writes lies in a temporary folder. The node has these resources whatever the machine has.

    Raises
    ------
    CannotStartError
        With the reason.
    """
    cluster = Cluster(Path(tempfile.mkdtemp(prefix="slurm-")))
    try:
        _start(cluster, cpus, memory_mb)
        yield cluster
    finally:
        _stop(cluster)
        shutil.rmtree(cluster.folder)


def _start(cluster: Cluster, cpus: int, memory_mb: int) -> None:
    missing = [name for name in NEEDED if not shutil.which(name, path=cluster.environment["PATH"])]
    if missing:
        raise CannotStartError(f"not installed: {', '.join(missing)} (Debian: slurm-wlm, munge)")
    folder = cluster.folder
    folder.chmod(0o755)  # munged wants its socket to be reachable by all
    for name in ("state", "spool", "bin"):
        (folder / name).mkdir()
    _write_srun(cluster)
    key = folder / "munge.key"
    key.touch(0o600)
    key.write_bytes(secrets.token_bytes(128))
    controller_port, node_port = _free_ports(2)
    (folder / "slurm.conf").write_text(
        SLURM_CONF.format(
            folder=folder,
            host=socket.gethostname().partition(".")[0],
            user=pwd.getpwuid(os.getuid()).pw_name,
            controller_port=controller_port,
            node_port=node_port,
            cpus=cpus,
            memory_mb=memory_mb,
        )
    )
    options = {
        "socket": "munge.socket",
        "key-file": "munge.key",
        "pid-file": "munge.pid",
        "log-file": "munge.log",
        "seed-file": "munge.seed",
    }
    munged = ["munged", "--foreground", *(f"--{key}={folder / x}" for key, x in options.items())]
    daemons = []
    for command in (munged, ["slurmctld", "-D"], ["slurmd", "-D"]):
        daemons.append(_daemon(cluster, command))
        if command is munged:
            _wait(cluster, daemons, (folder / "munge.socket").exists)
    _wait(cluster, daemons, lambda: _node_is_idle(cluster))


def _write_srun(cluster: Cluster) -> None:
    """An srun that knows its configuration: the plugin calls it without most variables of Slurm."""
    srun = shutil.which("srun", path=cluster.environment["PATH"])
    file = cluster.folder / "bin" / "srun"
    conf = cluster.environment["SLURM_CONF"]
    file.write_text(f'#!/bin/sh\nSLURM_CONF={conf} exec {srun} "$@"\n')
    file.chmod(0o755)


def _daemon(cluster: Cluster, command: list[str]) -> subprocess.Popen:
    """A daemon that ends with this process, however this process ends."""
    with (cluster.folder / f"{command[0]}.out").open("w") as output:
        return subprocess.Popen(
            ["setpriv", "--pdeathsig", "KILL", *command],
            env=cluster.environment,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # Ctrl-C is for the tests, which then stop the daemons
        )


def _node_is_idle(cluster: Cluster) -> bool:
    with contextlib.suppress(subprocess.SubprocessError):
        return (
            cluster.ask("sinfo", "--noheader", "--partition=short", "--format=%T").strip() == "idle"
        )
    return False


def _wait(cluster: Cluster, daemons: list[subprocess.Popen], ready) -> None:
    deadline = time.monotonic() + START_SECONDS
    while not ready():
        dead = any(daemon.poll() is not None for daemon in daemons)
        if dead or time.monotonic() > deadline:
            said = {path.stem: path.read_text()[-500:] for path in cluster.folder.glob("*.out")}
            raise CannotStartError(f"{'a daemon ended' if dead else 'no idle node'}: {said}")
        time.sleep(0.1)


def _free_ports(count: int) -> list[int]:
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def _stop(cluster: Cluster) -> None:
    """End every process of the cluster: those that it started are no children of this one."""
    while processes := cluster.processes():
        for process in processes:
            with contextlib.suppress(psutil.Error):
                process.kill()
        psutil.wait_procs(processes, timeout=5)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    with slurm_cluster() as started:
        sys.exit(subprocess.run(sys.argv[1:], env=started.environment, check=False).returncode)
