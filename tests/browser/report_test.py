"""The demo report in a real browser: drawn, zoomed, switched, printed, without a word on the console.

usage: report_test.py PROGRAM CAMPAIGN [SCREENSHOT_FOLDER]
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from figure_checks import FigureChecks
from page_checks import PageChecks
from webdriver import Browser

PROGRAM, CAMPAIGN = sys.argv[1:3]
SCREENSHOTS = sys.argv[3] if len(sys.argv) > 3 else None

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

    def tearDown(self):
        # Reading pixels back is this test's own doing, not the page's.
        said = [e for e in self.browser.console() if "willReadFrequently" not in e["message"]]
        self.assertEqual([e for e in said if e["level"] in ("SEVERE", "WARNING")], [])

    def plots(self):
        ids = self.browser.run("return [...document.querySelectorAll('svg.fig')].map(p => p.closest('figure').id);")
        self.assertGreater(len(ids), 3)
        return ids

    def show(self, figure):
        """Its tab is opened where it stands behind one."""
        self.browser.run(
            "const panel = document.getElementById(arguments[0]).closest('.panel');"
            "if (panel && panel.classList.contains('other')) document.getElementById(panel.getAttribute('aria-labelledby')).click();",
            figure)

    def test_needs_nothing_but_itself_and_opens_quickly(self):
        self.assertLess(self.page.stat().st_size, 8e6)
        loaded, resources = self.browser.run(
            "return [performance.getEntriesByType('navigation')[0].loadEventEnd,"
            " performance.getEntriesByType('resource').map(r => r.name).filter(n => !n.startsWith('data:'))];")
        self.assertEqual(resources, [])
        print("page of %.2f MB loaded in %.0f ms" % (self.page.stat().st_size / 1e6, loaded))
        self.assertLess(loaded, 10000)  # a guard against hanging; machines under test are busy

    def test_every_figure_has_series_within_its_axes(self):
        bad = self.browser.run("""
          return [...document.querySelectorAll('svg.fig')].filter(s => {
            const inner = s.querySelector('.in');
            return !inner.querySelector('[data-k] path') || /NaN|undefined/.test(s.outerHTML) || !s.querySelectorAll('.lg').length;
          }).map(s => s.closest('figure').id);""")
        self.assertEqual(bad, [])

    def test_zoom_by_dragging_and_back(self):
        plot = self.plots()[0]
        self.show(plot)
        box = "const s = document.getElementById(arguments[0]).querySelector('.fig .in'); return s.getAttribute('viewBox').split(' ').map(Number);"
        whole = self.browser.run("document.getElementById(arguments[0]).scrollIntoView({block: 'center'});" + box, plot)
        ticks = "return document.getElementById(arguments[0]).querySelector('.ticks').textContent;"
        labels = self.browser.run(ticks, plot)
        self.browser.drag("figure[id='%s'] svg.fig" % plot, -100, 60)
        part = self.browser.run(box, plot)
        self.assertLess(part[2], 0.8 * whole[2])
        self.assertNotEqual(self.browser.run(ticks, plot), labels)
        self.browser.run("document.getElementById(arguments[0]).querySelector('.fig')"
                         ".dispatchEvent(new KeyboardEvent('keydown', {key: 'Escape', bubbles: true}));", plot)
        self.assertEqual(self.browser.run(box, plot), whole)
        self.assertEqual(self.browser.run(ticks, plot), labels)

    def test_legend_switches_series(self):
        for plot in self.plots():
            self.show(plot)
            hidden = self.browser.run(
                "const f = document.getElementById(arguments[0]), key = f.querySelector('.lg'); key.dispatchEvent(new Event('click'));"
                "return [[...f.querySelectorAll('.in [data-k]')].filter(g => g.style.display === 'none').length,"
                " key.getAttribute('aria-checked')];", plot)
            self.assertGreater(hidden[0], 0, plot)
            self.assertEqual(hidden[1], "false")

    def test_linked_figures_zoom_together(self):
        seen = self.browser.run("""
          const links = new Map();
          for (const s of document.querySelectorAll('svg.fig')) {
            if (s.dataset.link) links.set(s.dataset.link, [...(links.get(s.dataset.link) || []), s]);
          }
          const first = [...links.values()].find(list => list.length > 1);
          if (!first) return null;
          const before = first[1].querySelector('.in').getAttribute('viewBox');
          first[0].dispatchEvent(new KeyboardEvent('keydown', {key: '+', bubbles: true, cancelable: true}));
          return [before, first[1].querySelector('.in').getAttribute('viewBox')];""")
        if seen is None:
            self.skipTest("no recorded FRFs in this campaign")
        self.assertNotEqual(*seen)

    def test_values_under_the_pointer(self):
        said = self.browser.run("""
          const f = document.getElementById(arguments[0]), s = f.querySelector('.fig'), r = s.getBoundingClientRect();
          s.dispatchEvent(new PointerEvent('pointermove', {clientX: r.left + r.width / 2, clientY: r.top + r.height / 3}));
          return f.querySelector('.readout').textContent;""", self.plots()[0])
        self.assertRegex(said, r"\d.*; .*\d")

    def test_a_screen_reader_is_told_everything(self):
        self.browser.run("document.querySelectorAll('details').forEach(d => { d.open = true; });")
        tree = self.browser.accessibility_tree()
        plots = self.browser.run("return [...document.querySelectorAll('svg.fig')].filter(p => p.clientWidth).length;")
        roles = [role for role, _, _ in tree]
        self.assertEqual(roles.count("application"), plots)  # each drawn plot is one
        self.assertGreaterEqual(roles.count("figure"), plots)
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
