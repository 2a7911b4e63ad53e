#!/usr/bin/env python3
"""Compares two result files of `supple bench --json`, or of supple_kernel_bench (Google Benchmark's JSON, run with repetitions; processor time).

Prints the medians and their ratio new / old beside an estimate of the noise: the larger of both files' spread between repetitions. A change is marked
only beyond twice the noise (and 2 %); what was timed once has no known noise and is never marked. Different results are marked as well.

Exit status: 0; with --limit R 1 if something is more than R times slower and marked; 2 for files that cannot be compared.
"""
import argparse
import json
import sys

LEAST_NOISE = 0.01


class Unreadable(Exception):
    pass


def median(values):
    ordered = sorted(values)
    middle = len(ordered) // 2
    return ordered[middle] if len(ordered) % 2 else 0.5 * (ordered[middle - 1] + ordered[middle])


class Timing:
    """Medians of repetitions [ms], and what else is worth comparing."""

    def __init__(self, repetitions, state_hash=None, trouble=""):
        self.repetitions = repetitions
        self.state_hash = state_hash
        self.trouble = trouble

    def median(self):
        return median(self.repetitions)

    def noise(self):
        if len(self.repetitions) < 2:
            return None
        return max(LEAST_NOISE, (max(self.repetitions) - min(self.repetitions)) / self.median())


def read_supple(data):
    timings = {}
    for result in data["results"]:
        trouble = ", ".join(result.get("flags", []))
        if not result.get("repeats_agree", True):
            trouble = (trouble + ", " if trouble else "") + "repetitions differ"
        repetitions = result.get("repeat_median_ms") or [result["step_ms"]["median"]]
        timings[result["name"]] = Timing(repetitions, result.get("state_hash"), trouble)
    return timings


def read_google(data):
    to_ms = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}
    repetitions = {}
    for run in data["benchmarks"]:
        if run.get("run_type") == "aggregate" or run.get("error_occurred"):
            continue
        name = run.get("run_name", run["name"])
        repetitions.setdefault(name, []).append(run.get("cpu_time", run["real_time"]) * to_ms[run.get("time_unit", "ns")])
    return {name: Timing(values) for name, values in repetitions.items()}


def read(path):
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
        return read_google(data) if "benchmarks" in data else read_supple(data)
    except (OSError, ValueError) as error:
        raise Unreadable(f"{path}: {error}") from error
    except (KeyError, TypeError) as error:
        raise Unreadable(f"{path}: neither results of supple bench nor of Google Benchmark ({error!r} is missing)") from error


def judge(old, new):
    """(ratio, noise or None, words)"""
    ratio = new.median() / old.median() if old.median() > 0 else float("inf")
    noises = [old.noise(), new.noise()]
    noise = None if None in noises else max(noises)
    words = []
    if noise is not None and abs(ratio - 1) > max(2 * noise, 0.02):
        words.append("SLOWER" if ratio > 1 else "faster")
    if old.state_hash and new.state_hash and old.state_hash != new.state_hash:
        words.append("other bits")
    if new.trouble:
        words.append(new.trouble)
    return ratio, noise, words


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--limit", type=float, metavar="R", help="fail where the new is more than R times slower, beyond noise")
    options = parser.parse_args(arguments)
    try:
        old, new = read(options.old), read(options.new)
    except Unreadable as error:
        print(f"compare.py: {error}", file=sys.stderr)
        return 2
    common = [name for name in old if name in new]
    if not common:
        print("compare.py: the files have no workload in common", file=sys.stderr)
        return 2
    width = max(len(name) for name in common)
    print(f"{'workload':{width}} {'old ms':>10} {'new ms':>10} {'new/old':>8} {'noise':>6}")
    too_slow = False
    for name in common:
        ratio, noise, words = judge(old[name], new[name])
        noise_text = f"{100 * noise:.0f} %" if noise is not None else "?"
        print(f"{name:{width}} {old[name].median():10.4g} {new[name].median():10.4g} {ratio:8.3f} {noise_text:>6}  {', '.join(words)}".rstrip())
        too_slow = too_slow or (options.limit is not None and ratio > options.limit and "SLOWER" in words)
    for name in sorted(set(old) ^ set(new)):
        print(f"{name}: only in the {'old' if name in old else 'new'} file")
    return 1 if too_slow else 0


if __name__ == "__main__":
    sys.exit(main())
