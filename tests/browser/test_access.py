"""Everybody can read it: axe-core in both themes, narrow screens, the outline."""

import importlib.util
import pathlib

import pytest
from browser import Browser, file_url
from selenium.webdriver.common.by import By

# The package itself wants another browser; only its axe-core is wanted here.
SPEC = importlib.util.find_spec("axe_playwright_python")
AXE = (pathlib.Path(SPEC.origin).parent / "axe.min.js").read_text()


@pytest.mark.parametrize("dark", [False, True])
def test_axe_finds_nothing(dark):
    with Browser(dark=dark) as browser:
        # Both kinds of sections: one that is packed is opened by its link.
        browser.get(file_url("failing", "#s-lambert"))
        browser.settle()
        browser.execute_script("document.querySelector('.discs').scrollIntoView()")
        browser.settle()
        # What lies out of sight is judged as well.
        browser.execute_script(
            "document.querySelectorAll('.subject, .manual').forEach(s => s.style.contentVisibility = 'visible');"
            "document.querySelectorAll('details:not([data-packed])').forEach(d => d.open = true)"
        )
        browser.settle()
        browser.set_script_timeout(180)
        browser.execute_script(AXE)
        found = browser.execute_async_script(
            "axe.run({exclude: [['svg']]}, {preload: false, resultTypes: ['violations']}).then(r => arguments[0](r), e => arguments[0](String(e)))"
        )
        assert isinstance(found, dict), found
        told = [
            f"{v['id']} ({v['impact']}): {n['target']} {n['failureSummary']}"
            for v in found["violations"]
            for n in v["nodes"][:3]
        ]
        assert not told, "\n".join(told)


def test_the_outline_has_no_gap():
    with Browser() as browser:
        browser.get(file_url("failing"))
        levels = browser.execute_script(
            "return [...document.querySelectorAll('h1,h2,h3,h4,h5,h6')].map(h => Number(h.tagName[1]))"
        )
        assert levels[0] == 1 and levels.count(1) == 1
        assert all(below - above <= 1 for above, below in zip(levels, levels[1:])), levels
        assert browser.find_element(By.TAG_NAME, "html").get_attribute("lang") == "en"
        for landmark in ["header", "main", "footer"]:
            assert browser.find_elements(By.TAG_NAME, landmark), landmark
        for table in browser.find_elements(By.TAG_NAME, "table"):
            assert table.find_elements(By.TAG_NAME, "caption")


def test_a_narrow_screen_scrolls_the_table_alone():
    with Browser(400, 800) as browser:
        browser.get(file_url("failing"))
        browser.settle()
        widths = "return [document.documentElement.scrollWidth, innerWidth]"
        whole, seen = browser.execute_script(widths)
        assert whole <= seen, f"{whole} px of {seen}"
        before, after = browser.execute_script(
            """const matrix = document.querySelector('.matrix');
            const left = () => matrix.querySelector('tbody th').getBoundingClientRect().left;
            const before = left();
            matrix.scrollLeft = 200;
            return [before, left(), matrix.scrollLeft];"""
        )[:2]
        assert before == after, "names stay in sight"
        browser.execute_script("document.querySelector('.matrix').scrollIntoView()")
        browser.picture("narrow")
        browser.get("about:blank")
        browser.get(file_url("failing", "#s-mutant-no-jacobian"))
        browser.settle()
        whole, seen = browser.execute_script(widths)
        assert whole <= seen, f"{whole} px of {seen}"
        browser.picture("narrow-section")


def test_the_skip_link_leads_to_the_table():
    with Browser() as browser:
        browser.get(file_url("failing"))
        skip = browser.find_element(By.CSS_SELECTOR, ".skip")
        skip.send_keys("\n")
        browser.settle()
        assert browser.execute_script("return document.activeElement.id") == "subjects-and-checks"
