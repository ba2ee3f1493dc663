#!/usr/bin/env python3
"""Kills, interrupts and terminates long commands at random moments. Called by tests/kills/run, which builds first.

A chain: the command is stopped up to five times by SIGKILL, SIGINT or SIGTERM, then left alone. It must end with exit
code 0 and with the file that an undisturbed run wrote, bit by bit, and leave no file of its own behind. While it is
stopped: no final file, and the exit code 130 after SIGINT, 143 after SIGTERM (or death by that signal before the
program watches for it).
"""
import argparse
import hashlib
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

OBJ = """mtllib room.mtl
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v -1 2 -1
v 1 2 -1
v 1 2 1
v -1 2 1
v -0.3 1.99 -0.3
v 0.3 1.99 -0.3
v 0.3 1.99 0.3
v -0.3 1.99 0.3
usemtl grey
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 4 8 7 3
f 1 5 8 4
f 2 3 7 6
usemtl lamp
f 9 10 11 12
"""
MTL = "newmtl grey\nKd 0.8 0.7 0.6\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n"
WATCHED = {signal.SIGINT: (130, -signal.SIGINT), signal.SIGTERM: (143, -signal.SIGTERM),
           signal.SIGKILL: (-signal.SIGKILL,)}


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16] if path.exists() else None


def rows_of(path):
    """A report has times in it: its rows by label and error."""
    if not path.exists():
        return None
    return sorted((row["label"], round(row.get("nrmse") or 0.0, 6)) for row in json.loads(path.read_text())["rows"])


class Case:
    def __init__(self, name, arguments, output, read=digest, grows=False):
        self.name, self.arguments, self.output, self.read = name, arguments, output, read
        self.grows = grows  # the output holds what is finished so far, as published


def cases(lucerna, scenes):
    room, rad = scenes / "room.obj", scenes / "room.rad"
    subprocess.run([lucerna, "radiosity", "generate", rad, "1", "--quiet"], check=True, stdout=subprocess.DEVNULL)
    solve = ["radiosity", "solve", room, "o.sol", "16", "--visibility", "rays", "--memory", "0.01"]
    original = ["radiosity", "solve", rad, "o.rad", "16", "--fidelity", "original"]
    path = ["render", room, "--technique", "path", "--camera", "0,1,0.9,0,1,0,70", "--size", "48x48", "--spp", "256"]
    bench = ["bench", "error", room, "--small", "--size", "16x16", "--reference-spp", "4", "--references", "refs"]
    return [
        Case("solve", solve + ["--edge", "0.2", "--error", "1e-6", "--solver", "jacobi"], "o.sol"),
        Case("refine", solve + ["--edge", "0.4", "--refinements", "2"], "o.sol"),
        Case("original", original + ["--save-every", "0.05", "--max-sweeps", "2"], "o.rad", grows=True),
        Case("path", path + ["-o", "o.pfm"], "o.pfm"),
        Case("checkpoint", path + ["--checkpoint", "o.film", "-o", "o.pfm"], "o.pfm"),
        Case("bench", bench + ["--techniques", "direct", "--frames", "1", "--out", "b"], "b/error.json", rows_of),
    ]


def try_case(case, lucerna, folder, kills, generator):
    command = [lucerna, *map(str, case.arguments), "--quiet"]
    faults = []

    def clean():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)

    def start():
        return subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    clean()
    begun = time.monotonic()
    whole = start()
    message = whole.communicate()[1]
    seconds = time.monotonic() - begun
    if whole.returncode != 0:
        return [f"undisturbed: exit {whole.returncode}: {message.strip()}"]
    expected = case.read(folder / case.output)
    files = sorted(p.relative_to(folder) for p in folder.rglob("*"))
    done = 0
    while done < kills:
        clean()
        history = []
        for _ in range(5):
            if done >= kills:
                break
            wanted = generator.choice(list(WATCHED))
            moment = generator.uniform(0.02, 1.05) * seconds
            process = start()
            try:
                process.communicate(timeout=moment)
            except subprocess.TimeoutExpired:
                process.send_signal(wanted)
                message = process.communicate()[1]
                done += 1
                history.append(f"{wanted.name} at {moment:.2f} s: exit {process.returncode}")
                if process.returncode == 0:
                    pass  # it had all but ended
                elif process.returncode not in WATCHED[wanted]:
                    faults.append(f"{history[-1]}: {message.strip()}")
                elif not case.grows and (folder / case.output).exists() and case.read(folder / case.output) != expected:
                    faults.append(f"{history[-1]}: a final file of unfinished work")
                continue
            break
        last = start()
        message = last.communicate()[1]
        if last.returncode != 0:
            faults.append(f"after {history}: exit {last.returncode}: {message.strip()}")
        elif case.read(folder / case.output) != expected:
            faults.append(f"after {history}: another result")
        else:
            left = [str(p) for p in sorted(x.relative_to(folder) for x in folder.rglob("*")) if p not in files]
            if left:
                faults.append(f"after {history}: left behind {left}")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lucerna", type=pathlib.Path, required=True, help="the program")
    parser.add_argument("--kills", type=int, default=20, help="signals a command (20)")
    parser.add_argument("--seed", type=int, default=None,
                        help="of the moments; chosen by the clock without it, and said")
    parser.add_argument("--only", default="", help="the command of that name")
    arguments = parser.parse_args()
    seed = arguments.seed if arguments.seed is not None else int(time.time())
    print(f"seed {seed}")
    failed = False
    with tempfile.TemporaryDirectory(prefix="lucerna-kills-") as name:
        folder = pathlib.Path(name)
        (folder / "room.obj").write_text(OBJ)
        (folder / "room.mtl").write_text(MTL)
        lucerna = arguments.lucerna.resolve()
        for case in cases(lucerna, folder):
            if arguments.only not in ("", case.name):
                continue
            begun = time.monotonic()
            faults = try_case(case, lucerna, folder / "work", arguments.kills, random.Random(f"{seed} {case.name}"))
            print(f"{case.name}: {arguments.kills} signals, {len(faults)} faults, {time.monotonic() - begun:.0f} s",
                  flush=True)
            for fault in faults:
                print(f"  {fault}")
            failed |= bool(faults)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
