"""The commands of README.md, apps/README.md and the tutorials, run as a reader would: each page in its order and in one folder.

usage: readme_test.py PROGRAM SOURCE_FOLDER

Run is every line of a code block that begins with `rigfit`, after `$ ` or in a block marked `sh` (a backslash
continues it). Output that is expected stands below it: in the same block after a `$ ` line, or in the block that
follows an `sh` block (then of its last command). Expected lines must appear in the output in their order; others may
stand between them (a line `...` says so to the reader). Words must be equal, numbers may differ by one in a thousand or two units of their last
digit; times (followed by s, ms or MB/s) are not compared. A block below an HTML comment that begins with
"not run:" is left out.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
NUMBER = re.compile(r"^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$")


def blocks(text):
    """(line, language, marked as not run, lines) of every fenced block, and its distance to the one before."""
    found, inside, before = [], None, ""
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            if inside is None:
                inside = {"line": number, "language": line[3:].strip(), "skip": before.startswith("<!-- not run:"), "lines": []}
            else:
                inside["end"] = number
                found.append(inside)
                inside = None
        elif inside is not None:
            inside["lines"].append(line)
        if line.strip():
            before = line.strip()
    return found


def commands(text):
    """(line, command, expected lines) in the order of the text."""
    result, last = [], None
    for block in blocks(text):
        if block["skip"]:
            last = None
            continue
        shell = block["language"] == "sh"
        current, joined = None, ""
        for line in block["lines"]:
            is_command = shell or line.startswith("$ ") or joined
            if is_command:
                joined += line[2:] if line.startswith("$ ") else line
                if joined.endswith("\\"):
                    joined = joined[:-1]
                    continue
                current = {"line": block["line"], "command": joined.split("  #")[0].strip(), "expected": []}
                result.append(current)
                joined = ""
            elif current is not None:
                current["expected"].append(line)
        if shell:
            last = current
        elif current is None and not block["language"] and last is not None and block["line"] - last["end"] < 4:
            last["expected"] = block["lines"]
            last = None
        if last is not None:
            last.setdefault("end", block["end"])
    return [c for c in result if c["command"].startswith("rigfit")]


def same_number(expected, given):
    a, b = float(expected), float(given)
    mantissa, _, exponent = expected.lower().partition("e")
    digits = len(mantissa.partition(".")[2])
    unit = 10.0 ** (int(exponent or 0) - digits)
    return abs(a - b) <= max(1e-3 * abs(a), 2.0001 * unit)


def same_line(expected, given):
    a, b = expected.split(), given.split()
    if len(a) != len(b):
        return False
    for i, (x, y) in enumerate(zip(a, b)):
        strip = lambda word: word.strip("(),:;%")
        x, y = strip(x), strip(y)
        if x == y:
            continue
        if not (NUMBER.match(x) and NUMBER.match(y)):
            return False
        timed = i + 1 < len(a) and strip(a[i + 1]) in ("s", "ms", "µs", "MB/s")
        if not timed and not same_number(x, y):
            return False
    return True


def missing(expected, given):
    """The first expected line that does not follow; None when all do."""
    at = 0
    for line in (l.strip() for l in expected):
        if not line or line == "...":
            continue
        while at < len(given) and not same_line(line, given[at]):
            at += 1
        if at == len(given):
            return line
        at += 1
    return None


class Readme(unittest.TestCase):
    def test_commands_do_what_the_readme_says(self):
        self.commands_do_what_it_says("README.md", 4)

    def test_commands_do_what_the_page_of_verbs_says(self):
        self.commands_do_what_it_says("apps/README.md", 12)

    def test_commands_do_what_the_page_of_benchmarks_says(self):
        self.commands_do_what_it_says("tests/bench/README.md", 1, compared=False)

    def test_tutorials_run_and_draw_their_pictures(self):
        for who, fewest in (("technician", 5), ("student", 4), ("consultant", 4), ("coupled", 4)):
            self.commands_do_what_it_says("apps/tutorials/%s/README.md" % who, fewest)

    def test_links_lead_somewhere(self):
        for page in subprocess.run(["git", "ls-files", "*.md"], cwd=SOURCE, capture_output=True, text=True).stdout.split():
            text = (SOURCE / page).read_text(encoding="utf-8")
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
                self.assertTrue((SOURCE / page).parent.joinpath(link).exists(), page + ": " + link)

    def commands_do_what_it_says(self, page, fewest, compared=True):
        text = (SOURCE / page).read_text(encoding="utf-8")
        todo = commands(text)
        self.assertGreaterEqual(len(todo), fewest, "%s has hardly any example left" % page)
        checked = 0
        with tempfile.TemporaryDirectory(prefix="rigfit-readme-") as folder:
            os.symlink(SOURCE / "testdata", os.path.join(folder, "testdata"))
            environment = dict(os.environ, PATH=str(PROGRAM.parent) + os.pathsep + os.environ["PATH"])
            for one in todo:
                with self.subTest("%s:%d: %s" % (page, one["line"], one["command"])):
                    run = subprocess.run(["bash", "-c", one["command"]], cwd=folder, env=environment,
                                         capture_output=True, text=True, timeout=300)
                    self.assertIn(run.returncode, (0, 4), run.stderr)
                    lines = [l.strip() for l in run.stdout.splitlines() if l.strip()]
                    lacking = missing(one["expected"], lines)
                    self.assertIsNone(lacking, "not in the output:\n  %s\nwhich is:\n%s" % (lacking, run.stdout))
                    checked += any(l.strip() for l in one["expected"])
            for picture in re.findall(r"!\[[^\]]*\]\(([^)/]+)\)", text):
                self.assertTrue(os.path.exists(os.path.join(folder, picture)), "%s: nothing draws %s" % (page, picture))
        self.assertTrue(checked > 0 or not compared, "no output is compared")

    def test_the_comparison_itself(self):
        self.assertTrue(same_line("EA  221745 N, std 161", "EA 221746 N, std 161"))
        self.assertFalse(same_line("EA 221745 N", "EA 223000 N"))
        self.assertFalse(same_line("EA 221745 N", "EI 221745 N"))
        self.assertTrue(same_line("took 0.3 s", "took 12.7 s"))
        self.assertIsNone(missing(["a 1", "...", "b 2"], ["a 1", "x", "b 2"]))
        self.assertEqual(missing(["a 1", "b 30"], ["a 1", "b 2"]), "b 30")
        text = "```sh\nrigfit x \\\n  y  # why\n```\n\n```\nout 1\n```\n<!-- not run: own files -->\n```sh\nrigfit z\n```\n"
        self.assertEqual([(c["command"], c["expected"]) for c in commands(text)], [("rigfit x   y", ["out 1"])])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
