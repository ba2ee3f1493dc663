#!/usr/bin/env python3
"""Plants faults, one at a time, and says which test noticed. Called by tests/mutants/run, which builds first.

A list (shaders.txt, engine.txt) has one block a fault:
    @ FILE        below shaders/ or the source folder
    - TEXT        of a line, which must stand exactly once in the file
    + TEXT        what it becomes
    ? LABEL FILTER  the tests that notice: <label>_tests with a GoogleTest filter
Shaders are read from a copy of the folder (LUCERNA_SHADERS); the engine is built again in a build folder of its own.
A fault that its own tests pass by is shown to the other tests of the suite before it counts as survived.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
LEAST_KILLED = 0.95
# Whole labels, for a fault that its own tests do not notice.
OTHERS = [("gl", "*"), ("physics", "*"), ("unit", "*")]


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
    """Whether the tests pass; a hang, a crash and a failure are all noticed."""
    label, pattern = test
    command = [build / "tests" / f"{label}_tests", f"--gtest_filter={pattern}", "--gtest_fail_fast", "--gtest_brief=1"]
    try:
        return subprocess.run(command, env=environment, timeout=seconds, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL).returncode == 0
    except subprocess.TimeoutExpired:
        return False


def noticed_by(fault, build, environment):
    for test in [fault.test] + OTHERS:
        if not passes(build, test, environment):
            return test
    return None


class ShaderTrial:
    """A copy of the shaders in which one file is changed at a time."""

    def __init__(self, build, folder):
        self.build, self.folder = build, folder
        shutil.copytree(SOURCE / "shaders", folder / "shaders")
        self.environment = dict(os.environ, LUCERNA_SHADERS=str(folder / "shaders"))

    def run(self, fault):
        file, text = plant(fault, self.folder)
        try:
            return noticed_by(fault, self.build, self.environment)
        finally:
            file.write_text(text)


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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="build folder with the test programs")
    parser.add_argument("--share", default="1/1", help="N/M: every M-th fault, beginning with the N-th")
    parser.add_argument("--only", default="", help="faults of files whose path contains this")
    parser.add_argument("--own", action="store_true",
                        help="show a fault to the tests that its list names and to no others")
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
    survivors = []
    passed = set()
    with tempfile.TemporaryDirectory(prefix="lucerna-mutants-") as folder:
        trials = {}
        for number, fault in enumerate(faults, 1):
            if fault.engine not in trials:
                trial = EngineTrial if fault.engine else ShaderTrial
                trials[fault.engine] = trial(arguments.build, pathlib.Path(folder))
            # Tests that fail without a fault would notice every one, no tests none.
            if not exists(arguments.build, fault.test):
                sys.exit(f"there are no tests {fault.test[0]} {fault.test[1]}")
            if fault.test not in passed and not passes(arguments.build, fault.test, dict(os.environ)):
                sys.exit(f"{fault.test[0]} {fault.test[1]} fails without any fault")
            passed.add(fault.test)
            begun = time.monotonic()
            test = trials[fault.engine].run(fault)
            took = time.monotonic() - begun
            verdict = f"noticed by {test[0]} {test[1]}" if test else "SURVIVED"
            if test and test != fault.test:
                verdict += f", not by {fault.test[0]} {fault.test[1]}"
            print(f"{number}/{len(faults)} {took:.0f} s: {fault}: {verdict}", flush=True)
            if not test:
                survivors.append(fault)
    killed = len(faults) - len(survivors)
    print(f"{killed} of {len(faults)} noticed")
    for fault in survivors:
        print(f"survived: {fault}")
    if killed < LEAST_KILLED * len(faults):
        sys.exit(1)


if __name__ == "__main__":
    main()
