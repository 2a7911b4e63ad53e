#!/usr/bin/env python3
"""compare.py on small files of both kinds."""
import contextlib
import io
import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
sys.dont_write_bytecode = True
import compare  # noqa: E402


def supple(**workloads):
    results = []
    for name, (repetitions, state_hash) in workloads.items():
        results.append({"name": name, "step_ms": {"median": repetitions[0]}, "repeat_median_ms": repetitions, "state_hash": state_hash,
                        "flags": [], "repeats_agree": True})
    return {"results": results}


def google(**kernels):
    runs = []
    for name, times in kernels.items():
        runs += [{"name": name, "run_name": name, "run_type": "iteration", "real_time": 7, "cpu_time": t, "time_unit": "us"} for t in times]
        runs.append({"name": name + "_mean", "run_name": name, "run_type": "aggregate", "real_time": 1e9, "time_unit": "us"})
    return {"benchmarks": runs}


class Compare(unittest.TestCase):
    def compare(self, old, new, *options):
        with tempfile.TemporaryDirectory() as folder:
            paths = []
            for name, content in (("old.json", old), ("new.json", new)):
                path = pathlib.Path(folder) / name
                path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
                paths.append(str(path))
            out, error = io.StringIO(), io.StringIO()
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
                status = compare.main([*paths, *options])
        return status, out.getvalue(), error.getvalue()

    def row(self, text, name):
        return next(line for line in text.splitlines() if line.startswith(name))

    def test_marks_what_is_beyond_the_noise_and_nothing_else(self):
        old = supple(steady=([1.0, 1.01, 1.02], "a"), noisy=([1.0, 1.3, 0.9], "a"), quicker=([2.0, 2.0, 2.02], "a"), once=([1.0], "a"))
        new = supple(steady=([1.2, 1.21, 1.22], "a"), noisy=([1.3, 1.2, 1.25], "a"), quicker=([1.0, 1.0, 1.01], "a"), once=([3.0], "a"))
        status, out, _ = self.compare(old, new)
        self.assertEqual(status, 0)
        self.assertIn("SLOWER", self.row(out, "steady"))
        self.assertIn("1.198", self.row(out, "steady"))
        self.assertNotIn("SLOWER", self.row(out, "noisy"))
        self.assertIn("faster", self.row(out, "quicker"))
        self.assertNotIn("SLOWER", self.row(out, "once"))
        self.assertIn("?", self.row(out, "once"))

    def test_limit_fails_only_beyond_it(self):
        old, new = supple(bar=([1.0, 1.0], "a")), supple(bar=([1.2, 1.2], "a"))
        self.assertEqual(self.compare(old, new, "--limit", "1.3")[0], 0)
        self.assertEqual(self.compare(old, new, "--limit", "1.1")[0], 1)
        self.assertEqual(self.compare(new, old, "--limit", "1.1")[0], 0)

    def test_other_bits_and_flags_are_said(self):
        new = supple(bar=([1.0, 1.0], "b"))
        new["results"][0]["flags"] = ["iteration_cap"]
        out = self.compare(supple(bar=([1.0, 1.0], "a")), new)[1]
        self.assertIn("other bits", out)
        self.assertIn("iteration_cap", out)

    def test_workloads_of_one_file_alone_are_said(self):
        out = self.compare(supple(bar=([1.0], "a"), gone=([1.0], "a")), supple(bar=([1.0], "a"), fresh=([1.0], "a")))[1]
        self.assertIn("gone: only in the old file", out)
        self.assertIn("fresh: only in the new file", out)

    def test_google_benchmark_leaves_aggregates_out(self):
        out = self.compare(google(matvec=[10, 11, 10]), google(matvec=[5, 5, 5]))[1]
        self.assertIn("0.500", self.row(out, "matvec"))
        self.assertIn("faster", self.row(out, "matvec"))
        self.assertIn("0.01", self.row(out, "matvec"))

    def test_refuses_what_is_no_result_file(self):
        for content in ("{", "{}", '{"results": [{"name": "bar"}]}'):
            status, _, error = self.compare(supple(bar=([1.0], "a")), content)
            self.assertEqual(status, 2)
            self.assertIn("new.json", error)
        self.assertEqual(self.compare(supple(a=([1.0], "a")), supple(b=([1.0], "a")))[0], 2)


if __name__ == "__main__":
    unittest.main()
