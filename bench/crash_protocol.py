#!/usr/bin/env python3
"""Death, failing disks and damage: does a resumed run end with the datasets of an undisturbed one?

Two jobs (a sweep at two resolutions, an index build; small generated surfaces, one of them inadmissible) are disturbed, again
and again, in one of these ways, drawn at random from a seed. Every third time the resumed run is disturbed, too, by a kill,
a failing or a short call, reads included:

kill      SIGKILL after a random time
point     SIGKILL at a call on one of the run's files: write, fsync, rename, open, truncate, unlink, mkdir (fault layer)
fault     such a call fails: ENOSPC or EIO, once or from then on, EROFS and EACCES for folders and files that are opened
short     a write or a read moves half of its bytes
space     the output lies on a file system that is too small (needs root; said where it cannot be mounted)
damage    one bit of a finished segment, of the journal or of the complete file flips, or a file is cut short

After each: exit status and message are right; `--resume` without the disturbance ends as an undisturbed run does, with equal
datasets but `seconds`; rows whose journal line was there keep their very seconds, that is, were not computed again; no parts
are left; `ricci verify` finds nothing. Damage must be named by `ricci verify`, or h5py reads all of the file, and all datasets
are equal.
Exit status 1 where one of that fails.
"""

import argparse
import errno
import hashlib
import json
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import h5py
import numpy as np

import running

FAULTS = {"write": ["ENOSPC", "EIO"], "sync": ["EIO", "ENOSPC"], "rename": ["EIO", "ENOSPC"],
          "open": ["EROFS", "EACCES", "ENOSPC"], "truncate": ["EIO"], "unlink": ["EIO"], "folder": ["EROFS", "ENOSPC"],
          "read": ["EIO"]}
TEXT = {name: subprocess.os.strerror(getattr(errno, name)) for names in FAULTS.values() for name in names}
KILL_POINTS = [kind for kind in FAULTS if kind != "read"]


def datasets(path):
    """Every dataset but seconds: name to bytes."""
    found = {}

    def visit(name, thing):
        if isinstance(thing, h5py.Dataset) and name.rsplit("/", 1)[-1] != "seconds":
            value = np.asarray(thing[()])
            found[name] = (thing.shape, str(thing.dtype), repr(value.tolist()) if value.dtype.hasobject else value.tobytes())

    with h5py.File(path) as file:
        file.visititems(visit)
    return found


def digest(path):
    return hashlib.sha256(repr(sorted(datasets(path).items())).encode()).hexdigest()


def digest_in_child(path):
    """The same; '' where h5py cannot read the file, or HDF5 dies of it."""
    done = subprocess.run([sys.executable, __file__, "--digest", str(path)], capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def row_seconds(group):
    """(item, vertex) to seconds of the sweep rows below a group of the final file, or of a segment."""
    found = {}

    def visit(name, thing):
        if isinstance(thing, h5py.Group) and "vertex" in thing and "seconds" in thing:
            for vertex, seconds in zip(thing["vertex"][()], thing["seconds"][()]):
                found[(name.split("/sweep")[0].removeprefix("items/"), int(vertex))] = seconds.tobytes()

    group.visititems(visit)
    return found


class Job:
    """A command that writes one output, and what it writes undisturbed."""

    def __init__(self, name, program, words, status):
        self.name, self.program, self.words, self.status = name, program, words, status

    def command(self, output, resume):
        return [self.program, *self.words, "-o", str(output), "--quiet", *(["--resume"] if resume else [])]

    def make_reference(self, folder):
        output = folder / f"{self.name}.reference.h5"
        started = time.monotonic()
        done = subprocess.run(self.command(output, False), capture_output=True, text=True, check=False)
        self.seconds = time.monotonic() - started
        if done.returncode != self.status:
            sys.exit(f"{self.name}: exit {done.returncode} undisturbed\n{done.stderr}")
        self.datasets, self.digest = datasets(output), digest(output)

    def calls(self, layer, folder):
        """How often each kind of call is made on the run's files."""
        log, output = folder / "calls.log", folder / "calls" / "out.h5"
        output.parent.mkdir()
        subprocess.run(self.command(output, False), capture_output=True, check=False,
                       env=layer.environment(output.parent, log=log))
        shutil.rmtree(output.parent)
        counts = Counter(line.split(" ", 1)[0] for line in log.read_text().splitlines())
        log.unlink()
        return counts


class FaultLayer:
    def __init__(self, library):
        self.library = library

    def environment(self, root, call=None, log=None):
        words = dict(subprocess.os.environ, LD_PRELOAD=str(self.library), RICCI_FAULT_ROOT=str(root))
        words.pop("RICCI_FAULT", None)
        if call:
            words["RICCI_FAULT_CALL"] = call
        if log:
            words["RICCI_FAULT_LOG"] = str(log)
        return words


class Protocol:
    def __init__(self, arguments, folder):
        self.ricci, self.folder = arguments.ricci, folder
        self.random = random.Random(arguments.seed)
        self.layer = FaultLayer(arguments.layer)
        self.jobs = make_jobs(arguments.ricci, folder, arguments.threads)
        for job in self.jobs:
            job.make_reference(folder)
            job.counts = job.calls(self.layer, folder)
        self.outcomes, self.problems, self.kept_rows = Counter(), [], 0
        self.number = 0

    def problem(self, what):
        self.problems.append(what)
        print(f"crash_protocol: {what}", file=sys.stderr)

    # One disturbance each. They leave self.place / out.h5 behind, and say what was done.

    def run(self, job, resume=False, kill_after=None, **environment):
        output = self.place / "out.h5"
        process = subprocess.Popen(job.command(output, resume), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=self.layer.environment(self.place, **environment) if environment else None)
        if kill_after is not None:
            time.sleep(kill_after)
            process.kill()
        out, error = process.communicate()
        return process.returncode, error

    def kill(self, job):
        after = self.random.uniform(0.0, 1.1 * job.seconds)
        status, _ = self.run(job, kill_after=after)
        return f"SIGKILL after {after:.3f} s", "killed" if status == -signal.SIGKILL else "had finished"

    def point(self, job):
        kind = self.random.choice([k for k in KILL_POINTS if job.counts[k]])
        call = f"{kind}:{self.random.randint(1, job.counts[kind])}:kill"
        status, _ = self.run(job, call=call)
        return f"kill at {call}", "killed" if status == -signal.SIGKILL else "had finished"

    def fault(self, job):
        kind = self.random.choice([k for k in FAULTS if job.counts[k]])
        name = self.random.choice(FAULTS[kind])
        call = f"{kind}:{self.random.randint(1, job.counts[kind])}{self.random.choice(['', '+'])}:{getattr(errno, name)}"
        status, error = self.run(job, call=call)
        for said in (TEXT[name], self.place.name):  # the run's folder, or a file within
            if status == 3 and said not in error:
                self.problem(f"{job.name}, {call}: exit 3, but the message does not say '{said}': {error[-300:]}")
        if status not in (3, job.status):
            self.problem(f"{job.name}, {call}: exit {status}: {error[-300:]}")
        return f"{name} at {call}", "told" if status == 3 else "harmless"

    def short(self, job):
        kind = self.random.choice(["write", "read"])
        call = f"{kind}:{self.random.randint(1, job.counts[kind])}:short"
        status, error = self.run(job, call=call)
        if status not in (3, job.status):
            self.problem(f"{job.name}, {call}: exit {status}: {error[-300:]}")
        return f"half of {call}", "told" if status == 3 else "carried on"

    def space(self, job):
        kilobytes = self.random.choice([4, 16, 64, 128, 256])
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(self.place)],
                                 capture_output=True, check=False).returncode == 0
        if not mounted:
            return "no small file system can be mounted here", "not tried"
        try:
            status, error = self.run(job)
            if status not in (3, job.status) or (status == 3 and TEXT["ENOSPC"] not in error):
                self.problem(f"{job.name}, {kilobytes} kB: exit {status}: {error[-300:]}")
            subprocess.run(["mount", "-o", "remount,size=64m", str(self.place)], check=True)
            kept = self.folder / "kept"
            shutil.copytree(self.place, kept)
        finally:
            subprocess.run(["umount", str(self.place)], check=True)
        shutil.rmtree(self.place)
        kept.rename(self.place)
        return f"{kilobytes} kB", "told" if status == 3 else "fitted"

    def damage(self, job):
        whole = self.random.random() < 0.4
        if whole:
            self.run(job)
        else:
            self.run(job, call=f"rename:{self.random.randint(max(2, job.counts['rename'] // 2), job.counts['rename'])}:kill")
        parts = self.place / "out.h5.parts"
        whole = whole or not parts.is_dir()  # how many blocks a sweep writes depends on its pace
        victims = [self.place / "out.h5"] if whole else sorted(p for p in parts.iterdir() if not p.name.endswith(".tmp"))
        victim = self.random.choice(victims)
        size = victim.stat().st_size
        cut = self.random.random() < 0.4
        with open(victim, "r+b") as file:
            if cut:
                size = self.random.randrange(size)
                file.truncate(size)
                done = f"{victim.name} cut to {size} bytes"
            else:
                at = self.random.randrange(size)
                file.seek(at)
                byte = file.read(1)[0]
                file.seek(at)
                file.write(bytes([byte ^ (1 << self.random.randrange(8))]))
                done = f"a bit of byte {at} of {victim.name} flipped"
        return self.after_damage(job, whole, done)

    def after_damage(self, job, whole, done):
        output = self.place / "out.h5"
        verified = subprocess.run([self.ricci, "verify", str(output)], capture_output=True, text=True, check=False)
        if verified.returncode not in (0, 1, 3):
            self.problem(f"{job.name}, {done}: verify exits {verified.returncode}")
        named = "out.h5" in verified.stdout + verified.stderr and verified.returncode != 0
        if whole:
            found = "named"
            if not named:
                if digest_in_child(output) != job.digest:
                    self.problem(f"{job.name}, {done}: verify finds nothing, but datasets differ or cannot be read")
                found = "did not matter"
            output.unlink()  # what a user does with a damaged file: away with it
            return done, found
        if not named:
            self.problem(f"{job.name}, {done}: unfinished, and verify does not say so")
        status, error = self.run(job, resume=True)
        if status == 3:  # a journal whose first line cannot be believed: nothing may be thrown away
            if "journal" not in error or not (self.place / "out.h5.parts").is_dir():
                self.problem(f"{job.name}, {done}: resume refused: {error[-300:]}")
            shutil.rmtree(self.place / "out.h5.parts")
            return done, "journal refused"
        return done, "named, made again"

    def proved_seconds(self):
        """Seconds of the rows that the journal proves, before the run is resumed."""
        parts, found = self.place / "out.h5.parts", {}
        for line in journal_lines(parts):
            if line.get("kind") == "sweep" and (parts / line["name"]).is_file():
                try:
                    with h5py.File(parts / line["name"]) as segment:
                        found.update({(line["item"], v): s for (_, v), s in row_seconds(segment).items()})
                except OSError:
                    pass  # damaged
        return found

    def once(self, kind):
        self.number += 1
        job = self.random.choice(self.jobs)
        self.place = self.folder / f"run{self.number}"
        self.place.mkdir()
        done, outcome = getattr(self, kind)(job)
        self.outcomes[(kind, outcome)] += 1
        self.check_resumed(job, done, kind != "damage")
        shutil.rmtree(self.place)

    def disturb_resumed(self, job):
        """A second disturbance, of the run that resumes; what was proved before must be proved after it."""
        kind = self.random.choice([k for k in FAULTS if job.counts[k]])
        how = self.random.choice(["kill", "short", *(str(getattr(errno, name)) for name in FAULTS[kind])])
        if how == "short" and kind not in ("write", "read"):
            how = "kill"
        # A resumed run has less to do: most of its calls come early.
        call = f"{kind}:{1 + int(job.counts[kind] * self.random.random() ** 3)}:{how}"
        before = self.proved_seconds()
        status, error = self.run(job, resume=True, call=call)
        if status not in (3, -signal.SIGKILL, job.status):
            self.problem(f"{job.name}, resumed, {call}: exit {status}: {error[-300:]}")
        if (self.place / "out.h5.parts").is_dir():
            after = self.proved_seconds()
            lost = [key for key, seconds in before.items() if after.get(key) != seconds]
            if lost:
                self.problem(f"{job.name}, resumed, {call}: {len(lost)} finished rows are not proved any more")
        self.outcomes[("resumed", {3: "told", -signal.SIGKILL: "killed"}.get(status, "had finished"))] += 1
        return before

    def check_resumed(self, job, done, undamaged):
        where, output = f"{job.name}, {done}", self.place / "out.h5"
        proved = self.proved_seconds() if undamaged else {}
        if undamaged and self.random.random() < 1 / 3:
            proved |= self.disturb_resumed(job)
        if output.exists() and not undamaged and datasets_or_none(output) != job.datasets:
            self.problem(f"{where}: the output that the resumed run left differs")
        status, error = self.run(job, resume=True)
        if status != job.status:
            self.problem(f"{where}: resumed: exit {status}: {error[-300:]}")
            return
        if datasets(output) != job.datasets:
            self.problem(f"{where}: resumed, datasets differ")
        if (self.place / "out.h5.parts").exists():
            self.problem(f"{where}: parts are left")
        verified = subprocess.run([self.ricci, "verify", str(output)], capture_output=True, text=True, check=False)
        if verified.returncode != 0:
            self.problem(f"{where}: verify: {verified.stdout}{verified.stderr}")
        with h5py.File(output) as file:
            final = row_seconds(file)
        again = [key for key, seconds in proved.items() if final.get(key) != seconds]
        self.kept_rows += len(proved) - len(again)
        if again:
            self.problem(f"{where}: {len(again)} finished rows were computed again, the first {again[0]}")


def journal_lines(parts):
    """What the journal says, line by line; nothing where it is not there."""
    lines = []
    for journal in parts.glob("journal*") if parts.is_dir() else []:
        for text in journal.read_bytes().splitlines():
            try:
                lines.append(json.loads(text))
            except ValueError:
                pass  # torn
    return lines


def datasets_or_none(path):
    try:
        return datasets(path)
    except (OSError, RuntimeError):
        return None


def make_jobs(ricci, folder, threads):
    def generate(name, faces):
        path = folder / f"{name}.off"
        subprocess.run([ricci, "generate", name, "--faces", str(faces), "-o", str(path), "--quiet"], check=True)
        return str(path)

    eight, pants, torus = generate("eight", 300), generate("pants", 200), generate("torus", 150)
    annulus, holed = generate("annulus", 150), generate("punctured-torus", 200)
    common = ["--threads", str(threads)]
    return [
        Job("sweep", ricci, ["sweep", eight, pants, torus, holed, "--vertices", "sample:8", "--resolutions", "input,150",
                             "--keep", "2", *common], 1),  # the torus admits no single cone
        Job("index", ricci, ["index", "build", eight, pants, torus, annulus, holed, "--max-length", "3", *common], 0),
    ]


def report(protocol, arguments):
    kinds = sorted({kind for kind, _ in protocol.outcomes})
    rows = [[kind, sum(n for (k, _), n in protocol.outcomes.items() if k == kind),
             ", ".join(f"{outcome} {n}" for (k, outcome), n in sorted(protocol.outcomes.items()) if k == kind)]
            for kind in kinds]
    table = running.markdown_table(["disturbance", "times", "outcomes"], rows)
    calls = running.markdown_table(["job", *FAULTS], [[j.name, *(j.counts[k] for k in FAULTS)] for j in protocol.jobs])
    return (f"# Crash protocol\n\n{running.command_note(arguments.ricci)}\n\n**{protocol.number} disturbances, "
            f"{len(protocol.problems)} problems**; {protocol.kept_rows} rows that were finished before were kept as they "
            f"were, none computed again.\n\n{table}\nCalls of an undisturbed run on its files, at any of which a process dies "
            f"or fails:\n\n{calls}")


def main():
    if sys.argv[1:2] == ["--digest"]:
        print(digest(sys.argv[2]))
        return 0
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.set_defaults(threads=2)
    parser.add_argument("--layer", default=str(running.ROOT / "build" / "tests" / "libricci_fault_layer.so"))
    parser.add_argument("--kills", type=int, default=20, help="at random moments; as many at random calls")
    parser.add_argument("--faults", type=int, default=20, help="failing calls; half as many short ones")
    parser.add_argument("--spaces", type=int, default=4)
    parser.add_argument("--damages", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--write", action="store_true", help="the table to docs/results/crash_protocol.md")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        protocol = Protocol(arguments, Path(folder).resolve())
        for kind, times in (("kill", arguments.kills), ("point", arguments.kills), ("fault", arguments.faults),
                            ("short", arguments.faults // 2), ("space", arguments.spaces), ("damage", arguments.damages)):
            for _ in range(times):
                protocol.once(kind)
    text = report(protocol, arguments)
    print(text)
    if arguments.write:
        running.write(running.RESULTS / "crash_protocol.md", text)
    return 1 if protocol.problems else 0


if __name__ == "__main__":
    sys.exit(main())
