"""The demo report in a real browser: drawn, zoomed, switched, moved, printed, without a word on the console.

usage: report_test.py PROGRAM CAMPAIGN [SCREENSHOT_FOLDER]
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from figure_checks import FigureChecks
from page_checks import PageChecks
from webdriver import Browser

PROGRAM, CAMPAIGN = sys.argv[1:3]
SCREENSHOTS = sys.argv[3] if len(sys.argv) > 3 else None

# Pixels of an element's canvases that are neither transparent nor the background, and a hash of all of them.
PAINTED = """
  let painted = 0, hash = 0;
  for (const canvas of arguments[0].querySelectorAll('canvas')) {
    if (!canvas.width || !canvas.height) continue;
    const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    for (let i = 0; i < data.length; i += 4) {
      if (data[i + 3] > 0) ++painted;
      hash = (hash * 31 + data[i] + 3 * data[i + 1] + 7 * data[i + 2] + 11 * data[i + 3]) | 0;
    }
  }
  return [painted, hash];
"""


class ReportInBrowser(PageChecks, FigureChecks, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="rigfit-report-")
        run = subprocess.run([PROGRAM, "report", CAMPAIGN, "--out", cls.folder.name, "--quiet", "--threads", "2"],
                             capture_output=True, text=True)
        assert run.returncode in (0, 4), run.stderr
        cls.page = pathlib.Path(cls.folder.name) / "report.html"
        cls.url = cls.page.as_uri()
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.folder.cleanup()

    def setUp(self):
        self.browser.media("prefers-color-scheme", "light")
        self.browser.open(self.url)
        self.browser.run("rigfit_draw_all();")

    def tearDown(self):
        # Reading pixels back is this test's own doing, not the page's.
        said = [e for e in self.browser.console() if "willReadFrequently" not in e["message"]]
        self.assertEqual([e for e in said if e["level"] in ("SEVERE", "WARNING")], [])

    def plots(self):
        ids = self.browser.run("return [...document.querySelectorAll('.plot')].map(p => p.dataset.plot);")
        self.assertGreater(len(ids), 3)
        return ids

    def show(self, plot):
        """Its tab is opened where it stands behind one."""
        self.browser.run(
            "const p = document.querySelector('.plot[data-plot=\"' + arguments[0] + '\"]'), panel = p.closest('.panel');"
            "if (panel && panel.classList.contains('other')) document.getElementById(panel.getAttribute('aria-labelledby')).click();"
            "rigfit_draw_all();", plot)

    def painted(self, plot):
        self.show(plot)
        return self.browser.run("const f = new Function('arguments', args_source); return f([document.querySelector("
                                "`.plot[data-plot=\"${arguments[0]}\"]`)]);".replace("args_source", repr(PAINTED)), plot)

    def test_needs_nothing_but_itself_and_opens_quickly(self):
        self.assertLess(self.page.stat().st_size, 8e6)
        loaded, resources = self.browser.run(
            "return [performance.getEntriesByType('navigation')[0].loadEventEnd,"
            " performance.getEntriesByType('resource').map(r => r.name).filter(n => !n.startsWith('data:'))];")
        self.assertEqual(resources, [])
        print("page of %.2f MB loaded in %.0f ms" % (self.page.stat().st_size / 1e6, loaded))
        self.assertLess(loaded, 10000)  # a guard against hanging; machines under test are busy

    def test_every_plot_is_drawn(self):
        for plot in self.plots():
            with self.subTest(plot):
                painted, _ = self.painted(plot)
                self.assertGreater(painted, 2000)

    def test_zoom_by_dragging_and_back(self):
        plot = self.plots()[0]
        css = '.plot[data-plot="%s"]' % plot
        whole = self.browser.run("const p = document.querySelector(arguments[0]); p.scrollIntoView({block: 'center'});"
                                 "return p.dygraph.xAxisRange();", css)
        self.browser.drag(css, -100, 120)
        part = self.browser.run("return document.querySelector(arguments[0]).dygraph.xAxisRange();", css)
        self.assertLess(part[1] - part[0], 0.5 * (whole[1] - whole[0]))
        self.browser.run("[...document.querySelector(arguments[0]).parentNode.querySelectorAll('button')]"
                         ".find(b => b.textContent === 'Whole range').click();", css)
        back = self.browser.run("return document.querySelector(arguments[0]).dygraph.xAxisRange();", css)
        for a, b in zip(whole, back):
            self.assertAlmostEqual(a, b, delta=1e-6 * abs(whole[1] - whole[0]))

    def test_legend_switches_series_and_axis_turns_logarithmic(self):
        for plot in self.plots():
            css = '.plot[data-plot="%s"]' % plot
            self.show(plot)
            _, before = self.painted(plot)
            switched = self.browser.run(
                "const p = document.querySelector(arguments[0]), box = p.parentNode.querySelector('input[type=checkbox]');"
                "box.click(); return p.dygraph.visibility().filter(v => !v).length;", css)
            self.assertGreater(switched, 0, plot)
            _, after = self.painted(plot)
            self.assertNotEqual(before, after, plot)
        logarithmic = self.browser.run(
            "const b = [...document.querySelectorAll('.plot-tools button')].find(b => /Logarithmic|Linear/.test(b.textContent));"
            "const p = b.closest('figure').querySelector('.plot'), was = p.dygraph.getOptionForAxis('logscale', 'y');"
            "b.click(); return [!!was, !!p.dygraph.getOptionForAxis('logscale', 'y')];")
        self.assertNotEqual(*logarithmic)

    def test_linked_plots_zoom_together_and_turn_to_decibels(self):
        self.plots()
        seen = self.browser.run("""
          const data = JSON.parse(document.getElementById('plots').textContent);
          const of_link = new Map();
          for (const p of document.querySelectorAll('.plot')) {
            const link = p.dygraph && data[p.dataset.plot].link;
            if (link) of_link.set(link, [...(of_link.get(link) || []), p]);
          }
          const first = [...of_link.values()].find(list => list.length > 2 && data[list[0].dataset.plot].decibels);
          if (!first) return null;
          const g = first[0].dygraph, whole = g.xAxisRange(), range = [whole[0] + 1, whole[1] - 1];
          g.updateOptions({ dateWindow: range });
          const others = first.map(p => p.dygraph.xAxisRange());
          [...first[0].parentNode.querySelectorAll('button')].find(b => b.textContent === 'dB').click();
          return [range, others, g.getOptionForAxis('logscale', 'y')];""")
        if seen is None:
            self.skipTest("no recorded FRFs in this campaign")
        for other in seen[1]:
            self.assertEqual(other, seen[0])
        self.assertFalse(seen[2])

    def test_values_by_keyboard(self):
        plot = self.plots()[0]
        said = self.browser.run(
            "const p = document.querySelector('.plot[data-plot=\"' + arguments[0] + '\"]'); p.focus();"
            "p.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight', bubbles: true, cancelable: true}));"
            "return [document.activeElement === p, p.parentNode.querySelector('.readout').textContent];", plot)
        self.assertTrue(said[0])
        self.assertRegex(said[1], r"\d")

    def test_every_plot_has_its_table_and_words(self):
        self.browser.run("document.querySelectorAll('details.values').forEach(d => { d.open = true; });"
                         "await new Promise(r => setTimeout(r, 500));")
        wrong = self.browser.run(
            "document.querySelectorAll('.tabs button').forEach(b => { b.click(); rigfit_draw_all(); });"
            "return [...document.querySelectorAll('.plot')].filter(p => !p.getAttribute('aria-label') ||"
            " !p.closest('figure').querySelector('details table tbody tr')).map(p => p.dataset.plot);")
        self.assertEqual(wrong, [])
        unnamed = self.browser.run("return [...document.querySelectorAll('th')].filter(t => !t.scope).length +"
                                   " [...document.querySelectorAll('canvas[tabindex]')].filter(c => !c.ariaLabel &&"
                                   " !c.getAttribute('aria-label')).length;")
        self.assertEqual(unnamed, 0)
        shown = self.browser.run("return document.body.innerText;")
        self.assertNotRegex(shown, r"\b(nan|NaN|undefined|null|inf)\b")

    def test_a_screen_reader_is_told_everything(self):
        # All folds but those of values: of these the first, as one is like the other.
        self.browser.run("document.querySelectorAll('details:not(.values)').forEach(d => { d.open = true; });"
                         "document.querySelector('details.values').open = true;"
                         "await new Promise(r => setTimeout(r, 500));")
        tree = self.browser.accessibility_tree()
        plots = self.browser.run("return [...document.querySelectorAll('.plot')].filter(p => p.clientWidth).length;")
        roles = [role for role, _, _ in tree]
        self.assertEqual(roles.count("application"), plots)  # each drawn plot is one
        self.assertGreaterEqual(roles.count("figure"), plots)
        # Its values besides, behind a fold that says whose they are.
        values = [name for role, name, _ in tree if role == "DisclosureTriangle" and re.match(r"Values as a table ?: \w", name)]
        self.assertEqual(len(values), plots)
        controls = ("button", "checkbox", "combobox", "link", "tab", "tablist", "tabpanel", "navigation")
        named = controls + ("application", "figure", "image", "table", "heading", "region")
        self.assertEqual([role for role, name, _ in tree if role in named and not name.strip()], [])
        levels = [properties["level"] for role, _, properties in tree if role == "heading"]
        self.assertEqual(levels[0], 1)
        self.assertEqual(levels.count(1), 1)
        jumps = [(a, b) for a, b in zip(levels, levels[1:]) if b > a + 1]
        self.assertEqual(jumps, [])
        self.assertEqual(roles.count("main"), 1)

    def test_tab_key_goes_down_the_page(self):
        # Positions in the page of what takes the focus one after the other, from the top on.
        first = self.browser.run(
            "const all = [...document.querySelectorAll('*')].filter(e => e.tabIndex >= 0 && e.getClientRects().length);"
            "return [all.filter(e => e.tabIndex > 0).length, all.filter(e => e.closest('[aria-hidden=true]')).length, all.length];")
        self.assertEqual(first[:2], [0, 0])
        self.assertGreater(first[2], 20)
        self.browser.run("window.scrollTo(0, 0); document.activeElement.blur();")
        seen = []
        for _ in range(25):
            self.browser.key("\ue004")
            seen.append(self.browser.run("const e = document.activeElement;"
                                         "return [...document.querySelectorAll('*')].indexOf(e);"))
        self.assertEqual(seen, sorted(set(seen)))

    def test_tabs_show_one_state_at_a_time(self):
        counts = self.browser.run(
            "return [...document.querySelectorAll('.tabs')].map(list => [...list.children].map(tab => { tab.click();"
            " return list.parentNode.querySelectorAll('.panel:not(.other)').length; }));")
        for count in counts:
            self.assertEqual(set(count), {1})
        moved = self.browser.run(
            "const list = document.querySelector('.tabs'); if (!list) return null; list.children[0].click(); list.children[0].focus();"
            "list.children[0].dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight', bubbles: true, cancelable: true}));"
            "return [document.activeElement === list.children[1], list.children[1].getAttribute('aria-selected')];")
        if moved is not None:
            self.assertEqual(moved, [True, "true"])

    def test_mode_shapes_move_turn_and_stop(self):
        hosts = self.browser.run("return [...document.querySelectorAll('.shapes')].map(s => s.id);")
        self.assertGreater(len(hosts), 0)
        script = ("const s = document.getElementById(arguments[0]); const f = new Function('arguments', args_source);"
                  "s.scrollIntoView(); await new Promise(r => setTimeout(r, 300)); const one = f([s]);"
                  "await new Promise(r => setTimeout(r, 350)); const two = f([s]); s.querySelector('.play').click();"
                  "await new Promise(r => setTimeout(r, 150)); const three = f([s]);"
                  "await new Promise(r => setTimeout(r, 250)); const four = f([s]);"
                  "s.querySelector('canvas').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft', cancelable: true}));"
                  "return [one, two, three, four, f([s])];").replace("args_source", repr(PAINTED))
        one, two, stopped, still, turned = self.browser.run(script, hosts[-1])
        self.assertGreater(one[0], 500)
        self.assertNotEqual(one[1], two[1], "the shape does not move")
        self.assertEqual(stopped[1], still[1], "the shape does not stop")
        self.assertNotEqual(still[1], turned[1], "the shape does not turn")

    def test_dark_and_light(self):
        light = self.browser.run("return getComputedStyle(document.body).backgroundColor;")
        self.browser.media("prefers-color-scheme", "dark")
        self.browser.open(self.url)
        dark = self.browser.run("rigfit_draw_all(); return getComputedStyle(document.body).backgroundColor;")
        brightness = lambda c: sum(int(v) for v in re.findall(r"\d+", c)[:3])
        self.assertGreater(brightness(light), 600)
        self.assertLess(brightness(dark), 200)
        self.shot("dark.png")

    def test_prints_as_a_sound_pdf_with_figures_as_text(self):
        path = os.path.join(self.folder.name, "report.pdf")
        self.browser.pdf(path)
        info = subprocess.run(["pdfinfo", path], capture_output=True, text=True)
        self.assertEqual(info.returncode, 0, info.stderr)
        self.assertGreater(int(re.search(r"Pages:\s+(\d+)", info.stdout).group(1)), 2)
        text = subprocess.run(["pdftotext", path, "-"], capture_output=True, text=True, check=True).stdout
        text = " ".join(text.split())
        title = self.browser.run("return document.querySelector('h1').textContent;")
        for words in (title, "Summary", "Provenance", "Warnings", "frequency, Hz"):
            self.assertTrue(words in text, "not in the PDF: " + words)

    def test_pages_links_and_anchors_lead_somewhere(self):
        broken = self.browser.run("return [...document.querySelectorAll('a[href^=\"#\"]')]"
                                  ".filter(a => !document.getElementById(a.hash.slice(1))).map(a => a.hash);")
        self.assertEqual(broken, [])
        files = self.browser.run("return [...document.querySelectorAll('figcaption a')].map(a => a.getAttribute('href'));")
        for file in files:
            self.assertTrue((pathlib.Path(self.folder.name) / file).is_file(), file)
        self.shot("light.png")

    def shot(self, name):
        if SCREENSHOTS:
            os.makedirs(SCREENSHOTS, exist_ok=True)
            self.browser.screenshot(os.path.join(SCREENSHOTS, pathlib.Path(CAMPAIGN).parent.name + "-" + name))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
