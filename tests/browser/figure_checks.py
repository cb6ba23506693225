"""Figures as rendered: labels that do not overlap, text and marks that stand out. That origins and series are told apart
without red and green is a matter of the palette: tests/apps/report/figures/palette_test.cc."""

import itertools

# Of every drawing shown: boxes of its texts, of its marks (sensors, masses, hits, supports) and its own, in page pixels.
DRAWN = """
  const box = e => { const b = e.getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; };
  return [...document.querySelectorAll(arguments[0])].filter(s => s.getClientRects().length).map(s => ({
    name: s.closest('figure') ? s.closest('figure').id : s.getAttribute('aria-label'), box: box(s),
    texts: [...s.querySelectorAll('text')].map(t => [t.textContent, ...box(t)]),
    marks: [...s.querySelectorAll('rect.rig-sensor, rect.rig-hit, circle, path.rig-fill')].map(box)}));
"""

# Leaves one picture of each kind on the page (states and tests differ in a number): a long page takes seconds a picture.
ONE_OF_EACH_KIND = """
  const kinds = new Set();
  const kept = [...document.querySelectorAll('figure')].filter(f => {
    const kind = f.id.replace(/\\d.*/, '');
    return f.querySelector('.picture svg') && !kinds.has(kind) && kinds.add(kind);
  });
  document.querySelector('main').replaceChildren(...kept);
  return document.querySelectorAll('.picture svg').length;
"""

# Texts of the n-th svg shown, with the colour that each is drawn in, then hides them.
TEXTS = """
  const svg = document.querySelectorAll(arguments[0])[arguments[1]];
  svg.scrollIntoView({block: 'start', inline: 'start'});
  await new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)));
  const at = svg.getBoundingClientRect();
  const texts = [...svg.querySelectorAll('text')].filter(t => t.textContent.trim()).map(t => {
    const b = t.getBoundingClientRect(), style = getComputedStyle(t);
    return [t.textContent, style.fill, b.left - at.left, b.top - at.top, b.right - at.left, b.bottom - at.top]; });
  svg.querySelectorAll('text').forEach(t => { t.style.visibility = 'hidden'; });
  return [[at.left + scrollX, at.top + scrollY, at.width, at.height], texts];
"""

# Contrast (WCAG 2) of each text with the colours that take a tenth of its box or more; the least of each text.
BEHIND = """
  const [data, texts] = arguments;
  const image = new Image(); image.src = 'data:image/png;base64,' + data; await image.decode();
  const canvas = document.createElement('canvas'); canvas.width = image.width; canvas.height = image.height;
  const c = canvas.getContext('2d', {willReadFrequently: true}); c.drawImage(image, 0, 0);
  const linear = v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  const light = p => 0.2126 * linear(p[0]) + 0.7152 * linear(p[1]) + 0.0722 * linear(p[2]);
  return texts.map(([words, colour, left, top, right, bottom]) => {
    const x = Math.max(0, Math.floor(left)), y = Math.max(0, Math.floor(top));
    const w = Math.min(image.width, Math.ceil(right)) - x, h = Math.min(image.height, Math.ceil(bottom)) - y;
    if (w <= 0 || h <= 0) return [words, colour, 'outside of its picture', 0];
    const d = c.getImageData(x, y, w, h).data, count = new Map();
    for (let i = 0; i < d.length; i += 4) {
      const key = d[i] + ',' + d[i + 1] + ',' + d[i + 2]; count.set(key, (count.get(key) || 0) + 1);
    }
    const own = light(colour.match(/[\\d.]+/g).map(Number));
    let least = 99, worst = '';
    for (const [key, n] of count) {
      if (n < 0.1 * w * h) continue;
      const other = light(key.split(',').map(Number));
      const ratio = (Math.max(own, other) + 0.05) / (Math.min(own, other) + 0.05);
      if (ratio < least) { least = ratio; worst = key; }
    }
    return [words, colour, worst, least];
  });
"""

# Fill or stroke of every mark of the figures that stands for a value, with the paper's colour.
MARKS = """
  const seen = new Set();
  for (const e of document.querySelectorAll('svg [data-k] path:not(.band), svg .rig-line, svg .rig-sensor, svg .rig-hit, svg .rig-mass, svg .support')) {
    if (e.closest('text') || e.matches('.band, .hollow, text') || !e.getClientRects().length) continue;
    const style = getComputedStyle(e);
    seen.add(style.stroke !== 'none' ? style.stroke : style.fill);
  }
  const canvas = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
  const rgb = c => { canvas.fillStyle = c; canvas.fillRect(0, 0, 1, 1); return [...canvas.getImageData(0, 0, 1, 1).data].slice(0, 3); };
  return [rgb(getComputedStyle(document.body).backgroundColor), [...seen].map(rgb)];
"""

def linear(rgb):
    return [v / 255 / 12.92 if v / 255 <= 0.04045 else ((v / 255 + 0.055) / 1.055) ** 2.4 for v in rgb]


def contrast(a, b):
    light = [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in (linear(a), linear(b))]
    return (max(light) + 0.05) / (min(light) + 0.05)


def overlap(a, b):
    """Smaller side of what two boxes share, px."""
    return min(min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1]))


class FigureChecks:
    """Mixed into the tests of a report, beside PageChecks."""

    def overlaps(self, css):
        found = []
        for drawing in self.browser.run(DRAWN, css):
            texts = drawing["texts"]
            for (one, *a), (other, *b) in itertools.combinations(texts, 2):
                if overlap(a, b) > 0.5:
                    found.append("%s: '%s' over '%s'" % (drawing["name"], one, other))
            for words, *a in texts:
                if any(overlap(a, mark) > 0.5 for mark in drawing["marks"]):
                    found.append("%s: '%s' over a mark" % (drawing["name"], words))
                left, top, right, bottom = drawing["box"]
                if a[0] < left - 0.5 or a[1] < top - 0.5 or a[2] > right + 0.5 or a[3] > bottom + 0.5:
                    found.append("%s: '%s' is cut" % (drawing["name"], words))
        return found

    def test_labels_of_the_rig_do_not_overlap(self):
        self.addCleanup(self.back_to_normal)
        for width in (390, 1024, 1440):
            with self.subTest(width=width):
                self.at_width(width)
                self.assertGreater(len(self.browser.run(DRAWN, "svg.rig")), 0)
                self.assertEqual(self.overlaps("svg.rig"), [])

    def test_text_of_figures_stands_out_from_what_is_behind_it(self):
        self.addCleanup(self.back_to_normal)
        for dark in (False, True):
            with self.subTest(dark=dark):
                self.at_width(1440, dark=dark)
                css = ".picture svg"
                faint = []
                for k in range(self.browser.run(ONE_OF_EACH_KIND)):
                    (x, y, width, height), texts = self.browser.run(TEXTS, css, k)
                    if not texts or width == 0:
                        continue
                    picture = self.browser.devtools("Page.captureScreenshot", captureBeyondViewport=True, clip={
                        "x": x, "y": y, "width": width, "height": height, "scale": 1})["data"]
                    for words, colour, behind, ratio in self.browser.run(BEHIND, picture, texts):
                        if ratio < 4.5:
                            faint.append((words, colour, behind, round(ratio, 2)))
                self.assertEqual(faint[:20], [])

    def test_marks_stand_out_from_the_paper(self):
        self.addCleanup(self.back_to_normal)
        for dark in (False, True):
            with self.subTest(dark=dark):
                self.at_width(1440, dark=dark)
                paper, marks = self.browser.run(MARKS)
                self.assertTrue(sum(paper) < 200 if dark else sum(paper) > 600)
                self.assertGreater(len(marks), 2)
                self.assertEqual([(m, round(contrast(m, paper), 2)) for m in marks if contrast(m, paper) < 3], [])
