"""The page around the figures: navigation, links into folds, widths, contrast, paper."""

import os
import re
import subprocess

# Text that does not stand out from what is behind it: contrast under 4.5, or under 3 for large letters (WCAG 2.1, 1.4.3).
FAINT = """
  const parts = c => (c.match(/[\\d.]+/g) || []).map(Number);
  const canvas = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
  const rgba = c => { canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = c; canvas.fillRect(0, 0, 1, 1);
                      const d = canvas.getImageData(0, 0, 1, 1).data; return [d[0], d[1], d[2], d[3] / 255]; };
  const linear = v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  const light = c => 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
  const over = (top, below) => [0, 1, 2].map(k => top[3] * top[k] + (1 - top[3]) * below[k]);
  const known = new Map();
  const behind = e => {
    if (!e) return [255, 255, 255];
    if (known.has(e)) return known.get(e);
    const own = rgba(getComputedStyle(e).backgroundColor);
    const result = own[3] === 1 ? own : over(own, behind(e.parentElement));
    known.set(e, result); return result;
  };
  const faint = [];
  for (const e of document.querySelectorAll('body *')) {
    if (!e.getClientRects().length || e.closest('script, style, option, svg')) continue;
    if (![...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim())) continue;
    const style = getComputedStyle(e);
    const drawn = e instanceof SVGElement ? style.fill : style.color;
    const under = behind(e), text = over(rgba(drawn), under);
    const pair = [light(text), light(under)].sort((a, b) => b - a);
    const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.66 && +style.fontWeight >= 700);
    const ratio = (pair[0] + 0.05) / (pair[1] + 0.05);
    if (ratio < (large ? 3 : 4.5)) faint.push(e.tagName + '.' + e.className + ' ' + ratio.toFixed(2) + ' ' + drawn + ' ' + e.textContent.trim().slice(0, 40));
  }
  return faint.slice(0, 20);
"""

# What reaches out of the page to the right, but for what scrolls by itself.
WIDER = """
  const wide = document.documentElement.clientWidth + 1, out = [];
  if (document.documentElement.scrollWidth > wide) out.push('the page: ' + document.documentElement.scrollWidth);
  for (const e of document.querySelectorAll('main *')) {
    const box = e.getBoundingClientRect();
    if (!box.width || box.right <= wide || e.closest('.table, .hidden, svg')) continue;
    out.push(e.tagName + '.' + e.className + '#' + e.id + ' ' + Math.round(box.right));
  }
  return out.slice(0, 10);
"""


# Tables and figures on paper that are wider than where they stand.
CUT_ON_PAPER = """
  const out = [];
  for (const e of document.querySelectorAll('main table, main figure, main svg')) {
    if (!e.getClientRects().length) continue;
    const cell = e.closest('.table, .picture, .static') || e.parentElement;
    const box = e.getBoundingClientRect(), room = cell.getBoundingClientRect();
    if (box.right > room.right + 1.5) out.push((e.id || e.tagName) + ' ' + Math.round(box.right - room.right));
  }
  return out;
"""


class PageChecks:
    """Mixed into the tests of a report: `browser`, `url`, `folder`, `page` are theirs."""

    def at_width(self, width, height=900, dark=False):
        self.browser.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                              mobile=width < 600)
        self.browser.media("prefers-color-scheme", "dark" if dark else "light")
        self.browser.open(self.url)

    def back_to_normal(self):
        self.browser.devtools("Emulation.clearDeviceMetricsOverride")

    def test_fits_every_width_and_stands_out_in_light_and_dark(self):
        self.addCleanup(self.back_to_normal)
        large = self.page.stat().st_size > 4e6  # drawn and looked at whole where that takes seconds, not a minute
        for width in (390, 1024, 1440):
            for dark in (False,) if large and width != 1440 else (False, True):
                with self.subTest(width=width, dark=dark):
                    self.at_width(width, dark=dark)
                    self.assertEqual(self.browser.run(WIDER), [])
                    if width != 1024 and not large:
                        self.assertEqual(self.browser.run(FAINT), [])
                    self.shot("%d-%s.png" % (width, "dark" if dark else "light"))

    def test_nothing_is_cut_on_paper(self):
        self.addCleanup(self.back_to_normal)
        width = round((210 - 2 * 15) / 25.4 * 96)  # between the margins, px
        self.browser.devtools("Emulation.setDeviceMetricsOverride", width=width, height=1000, deviceScaleFactor=1, mobile=False)
        self.browser.open(self.url)
        self.browser.devtools("Emulation.setEmulatedMedia", media="print")
        try:
            self.assertEqual(self.browser.run(CUT_ON_PAPER), [])
        finally:
            self.browser.devtools("Emulation.setEmulatedMedia", media="")

    def test_navigation_stays_in_view(self):
        self.addCleanup(self.back_to_normal)
        seen = ("const box = document.querySelector('.side .bar').getBoundingClientRect();"
                "return [box.top >= -1, box.bottom <= innerHeight, box.width > 0];")
        for width in (390, 1440):
            self.at_width(width)
            self.browser.run("window.scrollTo(0, document.documentElement.scrollHeight / 2);")
            self.assertEqual(self.browser.run(seen), [True, True, True], width)
        self.at_width(390)
        shown = "return document.getElementById('side-list').getClientRects().length > 0;"
        self.assertFalse(self.browser.run(shown))
        self.browser.run("document.querySelector('.menu').click();")
        self.assertTrue(self.browser.run(shown))
        self.assertEqual(self.browser.run("return document.querySelector('.menu').getAttribute('aria-expanded');"), "true")
        self.browser.run("document.querySelector('.side ol a').click();")
        self.assertFalse(self.browser.run(shown))

    def test_links_lead_into_folds_and_tabs(self):
        for css in ("details.fold table[id]", ".panel.other figure[id]"):
            target = self.browser.run("const e = document.querySelector(arguments[0]); return e && e.id;", css)
            if not target:
                continue
            self.browser.open("about:blank")
            self.browser.open(self.url + "#" + target)
            self.assertEqual(self.browser.run(
                "await new Promise(r => setTimeout(r, 300)); const e = document.getElementById(arguments[0]);"
                "return [e.getClientRects().length > 0, e.closest('.panel.other') === null];", target), [True, True], target)

    def test_figures_and_tables_are_numbered_through(self):
        for what in ("Figure", "Table"):
            numbers = self.browser.run(
                "return [...document.querySelectorAll('.number')].map(a => a.textContent)"
                ".filter(t => t.startsWith(arguments[0])).map(t => parseInt(t.replace(/\\D/g, '')));", what)
            self.assertGreater(len(numbers), 2)
            self.assertEqual(numbers, list(range(1, len(numbers) + 1)), what)

    def test_first_page_has_answers_with_verdicts(self):
        rows = self.browser.run("return [...document.querySelectorAll('#answers tbody tr')].map(r => [...r.cells].map(c => c.innerText));")
        self.assertTrue(2 <= len(rows) <= 14)
        for quantity, value, unit, how, verdict in rows:
            self.assertRegex(quantity, r"^[A-Z]")
            self.assertNotRegex(quantity, r"[A-Za-z]\.\w", "names are words")
            self.assertRegex(value, r"\d|not determined")
            self.assertTrue(how and verdict)
        self.assertEqual(self.browser.run("return document.querySelectorAll('.first-page svg.rig').length;"), 1)
        self.assertLessEqual(self.browser.run("return document.querySelectorAll('.first-page .distrust li').length;"), 5)

    def words_of(self, pdf):
        """By page: (xMin, yMin, xMax, yMax, word), in points."""
        text = subprocess.run(["pdftotext", "-bbox", pdf, "-"], capture_output=True, text=True, check=True).stdout
        pages = []
        for page in text.split("<page ")[1:]:
            size = [float(v) for v in re.search(r'width="([\d.]+)" height="([\d.]+)"', page).groups()]
            words = [tuple(float(v) for v in m[:4]) + (m[4],) for m in
                     re.findall(r'<word xMin="([-\d.]+)" yMin="([-\d.]+)" xMax="([-\d.]+)" yMax="([-\d.]+)">([^<]*)<', page)]
            pages.append((size, words))
        return pages

    def filled_of(self, pdf, dpi=30):
        """By page: where its last row with ink is, above the foot, as a share of the height between the margins."""
        raw = subprocess.run(["pdftoppm", "-r", str(dpi), "-gray", pdf], capture_output=True, check=True).stdout
        filled, at = [], 0
        while at < len(raw):
            head = re.match(rb"P5\s+(\d+)\s+(\d+)\s+255\s", raw[at:at + 40])
            width, height = int(head[1]), int(head[2])
            at += head.end()
            ink = [min(raw[at + row * width:at + (row + 1) * width]) < 200 for row in range(height)]
            at += width * height
            body = ink[round(height * 16 / 297):round(height * 280 / 297)]  # margins of 16 and 17 mm
            filled.append((max([row for row, dark in enumerate(body) if dark], default=-1) + 1) / len(body))
        return filled

    def test_paper_has_a_first_page_a_short_report_and_no_clipped_or_empty_pages(self):
        path = os.path.join(self.folder.name, "paper.pdf")
        self.browser.pdf(path)
        pages = self.words_of(path)
        appendix = None
        for number, (size, words) in enumerate(pages, 1):
            body = [w for w in words if w[3] < size[1] - 45]
            self.assertGreater(len(body), 5, "page %d is empty" % number)
            for x_low, _, x_high, _, word in words:
                self.assertTrue(x_low > 14 and x_high < size[0] - 14, "page %d: %s is cut" % (number, word))
            top = min(body, key=lambda w: (round(w[1] / 4), w[0]))
            if top[4] == "Appendix" and appendix is None:
                appendix = number
        self.assertIn("Warnings", [w[4] for w in pages[0][1]], "the first page is one page")
        self.assertIn("Contents", [w[4] for w in pages[1][1]])
        # Figures are text, too.
        text = " ".join(w[4] for _, words in pages for w in words)
        title = self.browser.run("return document.querySelector('h1').textContent;")
        for words in (title, "Summary", "Provenance", "Warnings", "frequency, Hz"):
            self.assertTrue(words in text, "not in the PDF: " + words)
        self.assertIsNotNone(appendix)
        self.assertLessEqual(appendix - 1, 8)
        # Where nothing forces a new page, one with less than a third of its height used is a gap.
        filled = self.filled_of(path)
        self.assertEqual(len(filled), len(pages))
        short = {number: round(share, 2) for number, share in enumerate(filled, 1)
                 if number not in (appendix - 1, len(pages)) and share < 1 / 3}
        self.assertEqual(short, {})
        self.assertGreater(sum(filled) / len(filled), 0.75)
        last = [w[4] for w in pages[-1][1] if w[1] > pages[-1][0][1] - 45]
        self.assertIn(str(len(pages)), last, "page numbers")
