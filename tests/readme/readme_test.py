"""The commands of README.md, apps/README.md, the tutorials and other pages, run as a reader would: each page in its order and in one folder.

usage: readme_test.py PROGRAM SOURCE_FOLDER [--draw]

Run is every line of a code block that begins with `rigfit`, after `$ ` or in a block marked `sh` (a backslash
continues it). Output that is expected stands below it: in the same block after a `$ ` line, or in the block that
follows an `sh` block (then of its last command). It is the output from its first line on; a line `...` stands for
lines that are left out, and what follows the last expected line need not be shown. Words must be equal and numbers
agree to the digits that are printed (one unit of the last one is allowed; counts are exact); only run times (after
`steps,` or `took`) are not compared. A block below an HTML comment that begins with "not run:" is left out.

A picture of a page is drawn by a command of that page. Its labels are compared with those of the picture in the source, numbers
as above, and the points of every line within a pixel. `--draw` (with Chromium and pdftoppm) replaces the pictures instead.
"""

import html
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zlib

PROGRAM, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
DRAW = "--draw" in sys.argv[3:]
TUTORIALS = ["apps/tutorials/%s/README.md" % who for who in ("technician", "student", "consultant", "coupled")]
OTHERS = ["ident/predict/README.md", "testdata/jalali2021/README.md"]
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
    mantissa, _, exponent = expected.lower().lstrip("+-").partition("e")
    whole, _, decimals = mantissa.partition(".")
    if not decimals and not exponent and len(whole) < 4:
        return a == b
    zeros = 0 if decimals else len(whole) - len(whole.rstrip("0"))
    return abs(a - b) <= 1.0001 * 10.0 ** (int(exponent or 0) - len(decimals) + zeros)


def same_line(expected, given):
    a, b = expected.split(), given.split()
    if len(a) != len(b):
        return False
    for i, (x, y) in enumerate(zip(a, b)):
        x, y = x.strip("(),:;%"), y.strip("(),:;%")
        if x == y or i > 0 and a[i - 1] in ("steps,", "took"):
            continue
        if not (NUMBER.match(x) and NUMBER.match(y) and same_number(x, y)):
            return False
    return True


def missing(expected, given):
    """The first expected line that does not follow; None when all do."""
    at, skip = 0, False
    for line in (l.strip() for l in expected):
        if not line or line == "...":
            skip = skip or bool(line)
            continue
        while skip and at < len(given) and not same_line(line, given[at]):
            at += 1
        if at == len(given) or not same_line(line, given[at]):
            return line
        at, skip = at + 1, False
    return None


def labels(svg):
    return [html.unescape(text) for text in re.findall(r"<(?:text|title|desc)\b[^>]*>([^<]*)<", svg)]


def lines(svg):
    """The numbers of every path, in pixels."""
    return [[float(x) for x in re.findall(r"-?\d+\.?\d*", d)] for d in re.findall(r'\bd="([^"]*\d[^"]*)"', svg)]


def same_path(a, b):
    """Curves are thinned to what a screen shows: another number of points may draw the same curve, of the same extent."""
    if len(a) != len(b):
        a, b = (min(a), max(a)), (min(b), max(b))
    return all(abs(x - y) <= 1 for x, y in zip(a, b))


def difference(drawn, kept):
    """What two SVG pictures differ in; empty: nothing."""
    a, b = labels(drawn), labels(kept)
    if len(a) != len(b):
        return "%d labels, not %d" % (len(a), len(b))
    for x, y in zip(a, b):
        if not same_line(y, x):
            return "label %r, not %r" % (x, y)
    a, b = lines(drawn), lines(kept)
    return "" if len(a) == len(b) and all(map(same_path, a, b)) else "other lines"


def first_page(report):
    """The words on the first page of a report, a line each."""
    page = re.search(r'<section class="first-page".*?</section>', report, re.S).group(0)
    return [" ".join(html.unescape(text).split()) for text in re.split(r"<[^>]+>", page) if text.strip()]


def png_chunk(kind, data):
    return len(data).to_bytes(4, "big") + kind + data + zlib.crc32(kind + data).to_bytes(4, "big")


PNG_TEXT = b"rigfit\0\0\0\0\0"  # keyword of an iTXt chunk without compression, language or translation


class Readme(unittest.TestCase):
    def test_commands_do_what_the_readme_says(self):
        self.commands_do_what_it_says("README.md", 4)

    def test_commands_do_what_the_page_of_verbs_says(self):
        self.commands_do_what_it_says("apps/README.md", 12)

    def test_commands_of_other_pages_run(self):
        for page in OTHERS:
            self.commands_do_what_it_says(page, 1, compared=False)

    def test_tutorials_run_and_draw_their_pictures(self):
        for page in TUTORIALS:
            self.commands_do_what_it_says(page, 4)

    def test_no_page_has_commands_that_are_not_run(self):
        run = ["README.md", "apps/README.md", *TUTORIALS, *OTHERS]
        for page in self.pages():
            lines = [line for block in blocks((SOURCE / page).read_text(encoding="utf-8")) for line in block["lines"]
                     if not block["skip"] and block["language"] != "text"]
            if page not in run:
                self.assertFalse([l for l in lines if re.match(r"(\$ )?rigfit ", l)], page)

    def test_links_lead_somewhere(self):
        for page in self.pages():
            text = (SOURCE / page).read_text(encoding="utf-8")
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
                self.assertTrue((SOURCE / page).parent.joinpath(link).exists(), page + ": " + link)

    def test_picture_of_the_report(self):
        """example.png carries the words of the page that it shows: they must be those of the report today."""
        kept = SOURCE / "apps/report/example.png"
        with tempfile.TemporaryDirectory(prefix="rigfit-readme-") as folder:
            command = [PROGRAM, "report", "testdata/virtual_laboratory/campaign.toml", "--quiet", "--out", folder + "/lab-report"]
            subprocess.run(command + ["--pdf"] * DRAW, cwd=SOURCE, check=True, timeout=300)
            words = first_page(pathlib.Path(folder, "lab-report/report.html").read_text(encoding="utf-8"))
            if DRAW:
                subprocess.run(["pdftoppm", "-r", "100", "-f", "1", "-l", "1", "-png", "-singlefile", folder + "/lab-report/report.pdf",
                                folder + "/example"], check=True)
                png = pathlib.Path(folder, "example.png").read_bytes()
                end = png.rindex(b"IEND") - 4
                kept.write_bytes(png[:end] + png_chunk(b"iTXt", PNG_TEXT + "\n".join(words).encode()) + png[end:])
        png = kept.read_bytes()
        at = png.index(b"iTXt" + PNG_TEXT)
        shown = png[at + 4 + len(PNG_TEXT):at + 4 + int.from_bytes(png[at - 4:at], "big")].decode().split("\n")
        self.assertEqual(len(words), len(shown))
        for today, line in zip(words, shown):
            self.assertTrue(same_line(line, today), "the picture shows %r, the report has %r: draw it again" % (line, today))

    def test_picture_of_the_benchmark(self):
        """Times are those of the machine: only the words are compared."""
        kept = SOURCE / "apps/bench/time_error.svg"
        with tempfile.TemporaryDirectory(prefix="rigfit-readme-") as folder:
            subprocess.run([PROGRAM, "bench", "--quiet", "--plot", "time_error.svg"], cwd=folder, check=True, timeout=300)
            drawn = pathlib.Path(folder, "time_error.svg").read_text(encoding="utf-8")
        if DRAW:
            kept.write_text(drawn, encoding="utf-8")
        words = lambda svg: [label for label in labels(svg) if not NUMBER.match(label)]
        today, shown = words(drawn), words(kept.read_text(encoding="utf-8"))
        self.assertEqual(len(today), len(shown), (today, shown))
        for x, y in zip(today, shown):
            self.assertTrue(same_line(y, x), "the picture shows %r, the program draws %r" % (y, x))

    @staticmethod
    def pages():
        return subprocess.run(["git", "ls-files", "*.md"], cwd=SOURCE, capture_output=True, text=True).stdout.split()

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
                drawn, kept = pathlib.Path(folder, picture), (SOURCE / page).parent / picture
                self.assertTrue(drawn.exists(), "%s: nothing draws %s" % (page, picture))
                if DRAW:
                    kept.write_bytes(drawn.read_bytes())
                differs = difference(drawn.read_text(encoding="utf-8"), kept.read_text(encoding="utf-8"))
                self.assertEqual(differs, "", "%s: %s is out of date" % (page, picture))
        self.assertTrue(checked > 0 or not compared, "no output is compared")

    def test_the_comparison_itself(self):
        self.assertTrue(same_line("EA  221745 N, std 161", "EA 221746 N, std 161"))
        self.assertFalse(same_line("EA  221745 N, std 161", "EA 221747 N, std 161"))
        self.assertTrue(same_line("205180", "205190"))
        self.assertFalse(same_line("4 of 5", "3 of 5"))
        self.assertFalse(same_line("1.84 to 2.16", "1.84 to 2.18"))
        self.assertFalse(same_line("for 3.5 s", "for 3.7 s"))
        self.assertFalse(same_line("EA 221745 N", "EA 223000 N"))
        self.assertFalse(same_line("EA 221745 N", "EI 221745 N"))
        self.assertTrue(same_line("took 0.3 s", "took 12.7 s"))
        self.assertIsNone(missing(["a 1", "...", "b 2"], ["a 1", "x", "b 2"]))
        self.assertEqual(missing(["a 1", "b 30"], ["a 1", "b 2"]), "b 30")
        self.assertEqual(missing(["a 1", "b 2"], ["a 1", "x", "b 2"]), "b 2")
        self.assertEqual(missing(["b 2"], ["a 1", "b 2"]), "b 2")
        svg = '<text x="1">EI 2.17</text><path d="M1.0 2.0L3.0 4.0"/>'
        self.assertEqual(difference(svg, svg.replace("4.0", "4.5")), "")
        self.assertEqual(difference(svg, svg.replace("4.0", "6.0")), "other lines")
        self.assertIn("label", difference(svg, svg.replace("2.17", "2.15")))
        text = "```sh\nrigfit x \\\n  y  # why\n```\n\n```\nout 1\n```\n<!-- not run: own files -->\n```sh\nrigfit z\n```\n"
        self.assertEqual([(c["command"], c["expected"]) for c in commands(text)], [("rigfit x   y", ["out 1"])])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
