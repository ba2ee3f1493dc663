#!/usr/bin/env python3
"""Plants faults, one at a time, and says which test noticed. Called by tests/mutants/run, which builds first.

A list (shaders.txt, engine.txt) has one block a fault:
    @ FILE        below shaders/ or the source folder
    - TEXT        of a line, which must stand exactly once in the file
    + TEXT        what it becomes
    ? LABEL FILTER  the tests that notice: <label>_tests with a GoogleTest filter
Shaders are read from a copy of the folder (LUCERNA_SHADERS), as many faults at once as there are processors; the engine
is built again in a build folder of its own, for one fault at a time. A fault that its own tests pass by is shown to
the other tests of the suite before it counts as survived.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
LEAST_KILLED = 0.95
# Whole labels, for a fault that its own tests do not notice. MutantsList is left out: it reads the sources with the
# fault in them, finds the text replaced, and would fail for every fault of the engine.
OTHERS = [("gl", "*"), ("physics", "*"), ("unit", "-MutantsList.*")]


class Fault:
    def __init__(self, engine, file, line):
        self.engine, self.file, self.line = engine, file, line
        self.before, self.after, self.test = "", "", ("gl", "*")

    @property
    def path(self):
        return self.file if self.engine else "shaders/" + self.file

    def __str__(self):
        return f"{self.path}: {self.before.strip()[:60]} -> {self.after.strip()[:60] or 'nothing'}"


def read_list(path, engine):
    faults = []
    for number, text in enumerate(path.read_text().splitlines(), 1):
        kind, rest = text[:1], text[2:]
        if kind == "@":
            faults.append(Fault(engine, rest, number))
        elif kind == "-":
            faults[-1].before = rest
        elif kind == "+":
            faults[-1].after = rest
        elif kind == "?":
            label, _, pattern = rest.partition(" ")
            faults[-1].test = (label, pattern)
        elif kind and kind != "#":
            sys.exit(f"{path}:{number}: a line begins with @, -, +, ? or #")
    for fault in faults:
        count = (SOURCE / fault.path).read_text().count(fault.before)
        if count != 1:
            sys.exit(f"{path}:{fault.line}: {fault.path} has the text {count} times, and it must be once: "
                     f"{fault.before}")
    return faults


def plant(fault, root):
    file = root / fault.path
    text = file.read_text()
    file.write_text(text.replace(fault.before, fault.after))
    return file, text


def exists(build, test):
    """A filter that no test's name fits passes whatever is planted."""
    label, pattern = test
    listed = subprocess.run([build / "tests" / f"{label}_tests", "--gtest_list_tests", f"--gtest_filter={pattern}"],
                            capture_output=True, text=True).stdout
    return "\n  " in listed


def passes(build, test, environment, seconds=900):
    """Whether the tests pass; a hang, a crash and a failure are all noticed. An interruption ends everything."""
    label, pattern = test
    command = [build / "tests" / f"{label}_tests", f"--gtest_filter={pattern}", "--gtest_fail_fast", "--gtest_brief=1"]
    try:
        status = subprocess.run(command, env=environment, timeout=seconds, stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL).returncode
    except subprocess.TimeoutExpired:
        return False
    if status in (-signal.SIGHUP, -signal.SIGINT, -signal.SIGTERM):
        sys.exit("interrupted")
    return status == 0


def noticed_by(fault, build, environment):
    for test in [fault.test] + OTHERS:
        if not passes(build, test, environment):
            return test
    return None


class ShaderTrial:
    """A copy of the shaders for each fault."""

    def __init__(self, build, folder):
        self.build, self.folder = build, folder

    def run(self, fault):
        with tempfile.TemporaryDirectory(dir=self.folder) as name:
            shaders = pathlib.Path(name) / "shaders"
            shutil.copytree(SOURCE / "shaders", shaders)
            plant(fault, shaders.parent)
            return noticed_by(fault, self.build, dict(os.environ, LUCERNA_SHADERS=str(shaders)))


class EngineTrial:
    """A copy of the sources, built once and then again for each fault."""

    def __init__(self, build, folder):
        self.folder, self.build = folder / "source", SOURCE / "build" / "mutants"
        ignore = lambda path, names: ([n for n in names if n in ("build", ".git", "out")]
                                      if pathlib.Path(path) == SOURCE else [])
        shutil.copytree(SOURCE, self.folder, ignore=ignore, symlinks=True)
        shutil.rmtree(self.build, ignore_errors=True)
        subprocess.run(["cmake", "-S", self.folder, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"],
                       check=True, stdout=subprocess.DEVNULL)

    def make(self, test):
        """Of the tests only those of the label: the others are built when a fault is shown to them."""
        return subprocess.run(["cmake", "--build", self.build, "--target", "lucerna", f"{test[0]}_tests"],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0

    def run(self, fault):
        file, text = plant(fault, self.folder)
        try:
            for test in [fault.test] + OTHERS:
                if not self.make(test):
                    sys.exit(f"{fault}: does not compile; that is no fault that a test could find")
                if not passes(self.build, test, dict(os.environ)):
                    return test
            return None
        finally:
            file.write_text(text)


class Kept:
    """What earlier runs found, by fault; a line of JSON each, so that an interrupted run goes on."""

    def __init__(self, file):
        self.file, self.lock, self.verdicts = file, threading.Lock(), {}
        if file and file.exists():
            for line in file.read_text().splitlines():
                key, test = json.loads(line)
                self.verdicts[key] = test and tuple(test)

    @staticmethod
    def key(fault):
        return "\n".join((fault.path, fault.before, fault.after, *fault.test, *(label for label, _ in OTHERS)))

    def add(self, fault, test):
        with self.lock:
            self.verdicts[self.key(fault)] = test
            if self.file:
                self.file.parent.mkdir(parents=True, exist_ok=True)
                with self.file.open("a") as file:
                    file.write(json.dumps([self.key(fault), test]) + "\n")


def at_once(count, work, items):
    """Calls work with each item, `count` at once; the first that raises ends all."""
    with concurrent.futures.ThreadPoolExecutor(count) as pool:
        futures = [pool.submit(work, item) for item in items]
        try:
            for future in concurrent.futures.as_completed(futures):
                future.result()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="build folder with the test programs")
    parser.add_argument("--share", default="1/1", help="N/M: every M-th fault, beginning with the N-th")
    parser.add_argument("--only", default="", help="faults of files whose path contains this")
    parser.add_argument("--own", action="store_true",
                        help="show a fault to the tests that its list names and to no others")
    parser.add_argument("--keep", type=pathlib.Path,
                        help="verdicts are kept in this file; those in it are not sought again")
    parser.add_argument("--check", action="store_true", help="only check that every fault can be planted")
    arguments = parser.parse_args()
    if arguments.own:
        OTHERS.clear()
    here = pathlib.Path(__file__).parent
    faults = read_list(here / "shaders.txt", False) + read_list(here / "engine.txt", True)
    first, step = (int(x) for x in arguments.share.split("/"))
    faults = [f for f in faults[first - 1::step] if arguments.only in f.path]
    print(f"{len(faults)} faults")
    if arguments.check:
        return
    kept = Kept(arguments.keep)
    left = [f for f in faults if kept.key(f) not in kept.verdicts]
    if len(left) < len(faults):
        print(f"{len(faults) - len(left)} verdicts are in {arguments.keep}")

    # Tests that fail without a fault would notice every one, no tests none.
    def passes_without(test):
        if not exists(arguments.build, test):
            sys.exit(f"there are no tests {test[0]} {test[1]}")
        if not passes(arguments.build, test, dict(os.environ)):
            sys.exit(f"{test[0]} {test[1]} fails without any fault")

    def try_fault(fault, trial):
        begun = time.monotonic()
        test = trial.run(fault)
        took = time.monotonic() - begun
        kept.add(fault, test)
        verdict = f"noticed by {test[0]} {test[1]}" if test else "SURVIVED"
        if test and test != fault.test:
            verdict += f", not by {fault.test[0]} {fault.test[1]}"
        number = sum(kept.key(f) in kept.verdicts for f in faults)
        print(f"{number}/{len(faults)} {took:.0f} s: {fault}: {verdict}", flush=True)

    processors = os.cpu_count()
    at_once(processors, passes_without, dict.fromkeys(f.test for f in left))
    with tempfile.TemporaryDirectory(prefix="lucerna-mutants-") as name:
        folder = pathlib.Path(name)
        shaders = ShaderTrial(arguments.build, folder)
        at_once(processors, lambda fault: try_fault(fault, shaders), [f for f in left if not f.engine])
        engine = None
        for fault in (f for f in left if f.engine):
            engine = engine or EngineTrial(arguments.build, folder)
            try_fault(fault, engine)
    survivors = [f for f in faults if not kept.verdicts[kept.key(f)]]
    killed = len(faults) - len(survivors)
    print(f"{killed} of {len(faults)} noticed")
    for fault in survivors:
        print(f"survived: {fault}")
    if killed < LEAST_KILLED * len(faults):
        sys.exit(1)


if __name__ == "__main__":
    main()
