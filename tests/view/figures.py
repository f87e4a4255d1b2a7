"""Figures of a view, measured: ``python -m tests.view.figures`` prints them. They judge nothing."""

import sys
import time

import numpy as np
from playwright.sync_api import sync_playwright

import six_wheel as sw
from tests.view.browsing import Page, launch

CHANGES = 60
PLAYED = 20.0  # [s]


def main() -> None:
    stamps = np.linspace(0.0, 600.0, 6000)
    twists = np.tile([0.3, 0.0, 0.1], (6000, 1))
    log = sw.simulate(sw.Rover.preset("husky"), (stamps, twists))
    with sync_playwright() as driver:
        browser = launch(driver)
        if browser is None:
            sys.exit("no chromium on this machine (CHROMIUM=PATH says where one is)")
        begin = time.perf_counter()
        with sw.view("perseverance", open=False, twist=(0.15, 0.0, 0.05)) as view:
            print(f"server ready      {time.perf_counter() - begin:.2f} s")
            begin = time.perf_counter()
            page = Page(browser, view.url)
            page.page.wait_for_selector("text=possible as commanded")
            took, size = time.perf_counter() - begin, page.frames[1] / 1e6
            print(f"page to panel     {took:.2f} s, {size:.2f} MB received")
            page.page.wait_for_timeout(5000)
            delays = []
            for k in range(CHANGES):
                page.page.wait_for_timeout(100)
                seen = page.frames[0]
                begin = time.perf_counter()
                view.twist = (0.15, 0.0, 0.05 + 0.0005 * k)
                while page.frames[0] == seen and time.perf_counter() - begin < 5.0:
                    page.page.wait_for_timeout(1)
                delays.append(1e3 * (time.perf_counter() - begin))
            median, last = np.percentile(delays, [50, 99])
            print(f"change to frame   median {median:.0f} ms, 99 % {last:.0f} ms")
            page.close()
        with sw.view(log, rover="husky", open=False) as view:
            page = Page(browser, view.url)
            page.ready("as recorded")
            frames, size, rows = page.frames[0], page.frames[1], set()
            page.page.keyboard.press("Space")
            begin = time.perf_counter()
            while time.perf_counter() - begin < PLAYED:
                page.page.wait_for_timeout(5)
                rows.add(view.motion.state.pose)
            span = time.perf_counter() - begin
            rate, width = (page.frames[0] - frames) / span, (page.frames[1] - size) / span
            moved = len(rows) / span
            print(f"playback          {rate:.1f} frames/s, {moved:.1f} poses/s, {width / 1e3:.0f} kB/s")
            print(f"complaints        {page.complaints}, requests to other hosts {page.elsewhere}")
            page.close()
        browser.close()


if __name__ == "__main__":
    main()
