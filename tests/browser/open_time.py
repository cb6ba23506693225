"""How large a page is and how long a browser takes to open it: until loaded, and until its first screen can be scrolled.

usage: open_time.py REPORT.html [TIMES]
"""

import pathlib
import sys
import time

from webdriver import Browser


def main():
    page = pathlib.Path(sys.argv[1]).resolve()
    times = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    loaded, scrolled = [], []
    with Browser() as browser:
        for _ in range(times):
            browser.open("about:blank")
            begin = time.monotonic()
            browser.open(page.as_uri())
            browser.run("window.scrollTo(0, 2000);"
                        "await new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)));")
            scrolled.append(time.monotonic() - begin)
            loaded.append(browser.run("return performance.getEntriesByType('navigation')[0].loadEventEnd;") / 1000)
    print("%.1f MB, loaded in %.2f s, scrolled in %.2f s (medians of %d)" % (
        page.stat().st_size / 1e6, sorted(loaded)[times // 2], sorted(scrolled)[times // 2], times))


if __name__ == "__main__":
    main()
