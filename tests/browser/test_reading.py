"""From the verdict to the bug."""

import base64
import json

import pytest
from browser import PAGES, Browser, file_url, served
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

FAILING = "mutant-no-jacobian"


@pytest.fixture(scope="module")
def browser():
    with Browser() as browser:
        yield browser


def text(browser, selector):
    return browser.find_element(By.CSS_SELECTOR, selector).text


def rows(browser):
    """Names of the rows in sight."""
    script = "return [...document.querySelectorAll('#matrix tbody tr')].filter(r => !r.hidden).map(r => r.dataset.section)"
    return browser.execute_script(script)


def report(folder="failing"):
    return json.loads((PAGES / folder / "report.json").read_text())


def test_the_head_says_the_verdict_and_what_the_run_was(browser):
    browser.get(file_url("failing"))
    assert "2 of 7 subjects failed" in text(browser, "h1").replace("\u00a0", " ")
    head = text(browser, "header")
    summary = report()["summary"]
    assert f"{summary['failed']} failed" in head
    for fact in ["seed", "false alarms", "detection limits", "processors", "browser"]:
        assert fact in head
    waivers = text(browser, "table.waivers")
    assert "unused" in waivers and "an old <bug>" in waivers


@pytest.mark.parametrize("over_http", [False, True])
def test_from_red_to_the_named_bug_in_two_clicks(browser, over_http):
    with served("failing") as address:
        browser.get(address if over_http else file_url("failing"))
        # One: a red cell.
        cell = f"#matrix tr[data-section='s-{FAILING}'] td.fail a"
        browser.find_element(By.CSS_SELECTOR, cell).click()
        browser.settle()
        found = browser.execute_script(
            """const target = document.querySelector('.target');
            const section = target.closest('.subject');
            const box = target.getBoundingClientRect();
            return [section.id, target.id, box.top, innerHeight, section.querySelector('.cause, .check').className,
                document.elementFromPoint(300, 12).closest('h3')?.textContent ?? ''];"""
        )
        section, check, top, height, first, heading = found
        assert section == f"s-{FAILING}" and check == f"s-{FAILING}--goodness-of-fit"
        assert 0 <= top < height / 2, "the check is in sight"
        assert first == "cause", "the diagnosis is the first thing"
        assert "pdf() lacks the Jacobian" in heading, "and its cause stays in sight"
        # Two: its cause, which is in sight, in the manual.
        browser.find_element(By.CSS_SELECTOR, f"#s-{FAILING} h3 a.slug").click()
        browser.settle()
        top = browser.execute_script(
            "return document.getElementById('cause-half-vector-jacobian').getBoundingClientRect().top"
        )
        assert -5 < top < height / 2
        assert "dωi" in text(browser, "#cause-half-vector-jacobian")


def test_the_list_at_the_top_leads_to_the_section(browser):
    browser.get(file_url("failing"))
    browser.find_element(By.LINK_TEXT, FAILING).click()
    browser.settle()
    assert browser.execute_script("return location.hash") == f"#s-{FAILING}"
    section = text(browser, f"#s-{FAILING}")
    expected = next(d for d in report()["diagnoses"] if d["subject"] == FAILING)
    for part in [expected["statement"], expected["repair"], *expected["evidence"]]:
        assert part in section
    command = next(r["command"] for r in report()["results"] if r["verdict"] == "fail")
    assert command.split(" --theta")[0] in section


def test_filters_are_kept_in_the_address(browser):
    browser.get(file_url("failing"))
    assert len(rows(browser)) == 7
    # With the keyboard alone.
    box = browser.find_element(By.CSS_SELECTOR, "input[name=verdict][value=fail]")
    box.send_keys(Keys.SPACE)
    assert rows(browser) == [f"s-{FAILING}", "s-mutant-value-over-wi-n"]
    assert text(browser, "#shown") == "2 of 7 subjects"
    hidden = "return document.getElementById('s-lambert').hidden"
    assert browser.execute_script(hidden), "sections follow the table"
    check = browser.find_element(By.CSS_SELECTOR, "select[name=check]")
    check.send_keys("normalization")
    assert rows(browser) == [f"s-{FAILING}"]
    box.send_keys(Keys.SPACE)
    check.send_keys(Keys.HOME)
    browser.find_element(By.CSS_SELECTOR, "input[name=q]").send_keys("SPARROW 0.02")
    assert len(rows(browser)) == 1
    address = browser.current_url
    browser.get("about:blank")
    browser.get(address)
    assert len(rows(browser)) == 1 and text(browser, "#shown") == "1 of 7 subjects"
    browser.find_element(By.CSS_SELECTOR, "#filters button[type=reset]").click()
    browser.settle()
    assert len(rows(browser)) == 7 and "#" not in browser.current_url


def test_a_permalink_opens_a_packed_section_at_a_check(browser):
    name = "s-torrance-sparrow-alpha-0.02"
    browser.get(file_url("failing"))
    anchor = next(row for row in rows(browser) if row.startswith(name))
    browser.get("about:blank")
    browser.get(file_url("failing", f"#{anchor}--energy"))
    browser.settle()
    target = browser.find_element(By.CSS_SELECTOR, ".target")
    assert target.get_attribute("id") == f"{anchor}--energy" and "energy" in target.text
    # The cell of a check that passes leads there as well.
    browser.execute_script("scrollTo(0, 0)")
    browser.find_element(By.CSS_SELECTOR, "#matrix tr[data-section='s-lambert'] td.pass").click()
    browser.settle()
    assert browser.find_element(By.CSS_SELECTOR, ".target").get_attribute("id") == "s-lambert--sanity"


def test_what_changed_is_told_and_marked(browser):
    browser.get(file_url("compared"))
    worse, better = browser.find_elements(By.CSS_SELECTOR, "table.changes")
    assert "What got worse" in worse.text and "normalization verdict pass fail" in worse.text
    assert "What got better" in better.text and "energy verdict fail pass" in better.text
    section = browser.find_element(By.CSS_SELECTOR, "section[aria-labelledby=compared]").text
    assert "New: rough-dielectric" in section
    browser.find_element(By.CSS_SELECTOR, "input[name=changed]").click()
    assert rows(browser) == ["s-lambert", f"s-{FAILING}"]
    browser.picture("compared")
    better.find_element(By.TAG_NAME, "a").click()
    browser.settle()
    assert browser.find_element(By.CSS_SELECTOR, ".target").get_attribute("id") == "s-lambert--energy"
    assert "fail → pass" in text(browser, "#s-lambert .changed")


def test_a_command_is_copied(browser):
    with served("failing") as address:
        browser.get(address)
        origin = address.removesuffix("/index.html")
        permissions = ["clipboardReadWrite", "clipboardSanitizedWrite"]
        browser.execute_cdp_cmd("Browser.grantPermissions", {"origin": origin, "permissions": permissions})
        check = f"#s-{FAILING} .check"
        expected = browser.execute_script(f"return document.querySelector('{check} code.command').textContent")
        button = browser.find_element(By.CSS_SELECTOR, f"{check} button.copy")
        browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", button)
        button.click()
        browser.settle()
        assert button.text == "Copied" and text(browser, "#said") is not None
        copied = browser.execute_async_script(
            "navigator.clipboard.readText().then(arguments[0], e => arguments[0](String(e)))"
        )
        assert copied == expected and copied.startswith("gonio check")


def test_without_script_failures_are_still_told():
    with Browser() as browser:
        browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
        browser.get(file_url("failing"))
        body = text(browser, "body")
        assert "pdf() lacks the Jacobian" in body and "gonio check mutant-no-jacobian" in body
        assert browser.find_elements(By.CSS_SELECTOR, "#filters:not([hidden])") == []
        figure = browser.find_element(By.CSS_SELECTOR, f"#s-{FAILING} .stand-in")
        assert figure.is_displayed(), "a picture stands for the discs"
        assert not browser.find_elements(By.CSS_SELECTOR, ".scripted")


def test_prints_open_and_without_controls(browser):
    browser.get(file_url("failing"))
    browser.media(kind="print")
    shown = "return [...document.querySelectorAll(arguments[0])].filter(e => e.checkVisibility()).length"
    for controls in ["#filters", "button", "input", ".skip"]:
        assert browser.execute_script(shown, controls) == 0, controls
    browser.media()
    browser.execute_script("dispatchEvent(new Event('beforeprint'))")
    browser.media(kind="print")
    assert browser.execute_script(shown, ".stand-in svg") >= 2, "pictures stand for the discs"
    assert browser.execute_script(shown, ".discs") == 0
    closed = "return [...document.querySelectorAll('.subject:not(.packed) details')].filter(d => !d.open).length"
    assert browser.execute_script(closed) == 0
    browser.media()
    printed = browser.execute_cdp_cmd("Page.printToPDF", {"printBackground": False})
    pdf = base64.b64decode(printed["data"])
    assert pdf.startswith(b"%PDF") and len(pdf) > 50_000
    (PAGES / "failing.pdf").write_bytes(pdf)


def test_looks(browser):
    browser.resize(1280, 1400)
    browser.get(file_url("failing"))
    browser.picture("light")
    browser.get("about:blank")
    browser.get(file_url("failing", f"#s-{FAILING}"))
    browser.picture("light-section")
    browser.media([{"name": "prefers-color-scheme", "value": "dark"}])
    browser.picture("dark-section")
    browser.execute_script("scrollTo(0, 0)")
    browser.picture("dark")
    theme = browser.find_element(By.ID, "theme")
    ground = "return getComputedStyle(document.body).backgroundColor"
    assert browser.execute_script(ground) == "rgb(21, 23, 26)"
    theme.click()
    assert browser.execute_script(ground) == "rgb(255, 255, 255)" and theme.text == "Theme: light"
    browser.media([{"name": "prefers-color-scheme", "value": "light"}])
    browser.resize(1280, 900)
