"""Discs that can be read: against the evidence, cell by cell."""

import gzip
import json
import re

import pytest
from browser import PAGES, Browser, file_url, served
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

FAILING = "s-mutant-no-jacobian"


@pytest.fixture(scope="module")
def browser():
    with Browser() as browser:
        yield browser


def evidence(folder, path):
    return json.loads(gzip.decompress((PAGES / folder / path).read_bytes()))


def discs(browser, section):
    """The discs of a section, drawn."""
    holder = browser.find_element(By.CSS_SELECTOR, f"#{section} .discs")
    browser.execute_script("arguments[0].scrollIntoView()", holder)
    ready = "return Boolean(arguments[0].discs?.cells)"
    for _ in range(40):
        browser.settle()
        if browser.execute_script(ready, holder):
            return holder
    raise AssertionError(f"no cells: {holder.text}")


def numbers(reading):
    """observed and expected of a reading."""
    found = re.search(r"observed ([\d.e−]+), expected ([\d.e−]+)", reading)
    assert found, reading
    return [float(text.replace("−", "-")) for text in found.groups()]


def test_cells_are_those_of_the_library_in_every_chart(browser):
    script = """
    const [path, found, done] = arguments;
    const directions = found.map(f => f.direction);
    const values = cells => directions.map(d => {
        const leaf = locate(cells, d);
        return [cells.observed[leaf], cells.expected[leaf], solidAngle(cells, leaf)];
    });
    (async () => {
        const carried = await load({evidence: path}, () => {});
        const own = cellsOfEvidence(JSON.parse(new TextDecoder().decode(
            await unpack(new Uint8Array(await (await fetch(path)).arrayBuffer())))));
        done([values(carried), values(own)]);
    })().catch(error => done(String(error)));
    """
    with served("shapes") as address:
        browser.get(address)
        cases = json.loads((PAGES / "shapes/expected.json").read_text())
        assert len(cases) == 3
        for case in cases:
            got = browser.execute_async_script(script, case["evidence"], case["found"])
            assert isinstance(got, list), got
            for values, rounding in zip(got, [1 / 32, 1e-6]):
                # The page keeps cuts to 2⁻¹⁷ of a cell: a direction in a thousand may lie on the other side.
                wrong = 0
                for value, found in zip(values, case["found"]):
                    wrong += value[0] != found["observed"]
                    if value[0] == found["observed"]:
                        assert abs(value[1] - found["expected"]) <= rounding
                        assert abs(value[2] / found["steradians"] - 1) < 2e-3
                assert wrong <= (2 if rounding > 1e-3 else 0), (case["evidence"], wrong)


def test_a_reading_is_what_was_counted(browser):
    browser.get(file_url("failing"))
    holder = discs(browser, FAILING)
    canvas = holder.find_element(By.CSS_SELECTOR, "canvas")
    ActionChains(browser).move_to_element_with_offset(canvas, 40, -30).perform()
    reading = holder.find_element(By.CSS_SELECTOR, ".reading")
    assert reading.get_attribute("aria-live") == "polite"
    observed, expected = numbers(reading.text)
    path, direction = browser.execute_script(
        """const d = arguments[0].discs;
        const [, theta, phi] = arguments[1].match(/θ ([\\d.]+)°, φ ([\\d.]+)°/).map(Number);
        const [t, p] = [theta * Math.PI / 180, phi * Math.PI / 180];
        return [d.cases[d.number].evidence, [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)]];""",
        holder,
        reading.text,
    )
    measured = evidence("failing", path)
    draws = measured["draws"][0]
    pairs = [(c, p * draws["samples"]) for c, p in zip(draws["counts"], measured["integrals"]["pdf"])]
    near = [e for c, e in pairs if c == observed and abs(e - expected) < max(0.04, 1e-4 * e)]
    assert near, f"no cell has {observed} and {expected} at {direction}"
    # Shares of the whole, so that a disc of zeros does not pass.
    total = browser.execute_script("return arguments[0].discs.cells.observed.reduce((a, b) => a + b)", holder)
    assert total == sum(draws["counts"]) > 10_000
    sides = browser.execute_script("return arguments[0].querySelectorAll('.disc-row').length", holder)
    assert sides == 1, "nothing is reflected to the back"


def test_the_keyboard_moves_the_crosshair(browser):
    browser.get(file_url("failing"))
    holder = discs(browser, FAILING)
    row = holder.find_element(By.CSS_SELECTOR, ".disc-row")
    reading = holder.find_element(By.CSS_SELECTOR, ".reading")
    row.send_keys(Keys.ARROW_RIGHT)
    first = reading.text
    row.send_keys(Keys.ARROW_UP)
    assert numbers(first) and numbers(reading.text) and first != reading.text
    # And lets go: Tab leads on.
    row.send_keys(Keys.TAB)
    assert not browser.execute_script("return arguments[0].contains(document.activeElement)", row)


def test_the_slider_changes_the_case(browser):
    browser.get(file_url("failing"))
    holder = discs(browser, FAILING)
    slider = holder.find_element(By.CSS_SELECTOR, "input[type=range]")
    place = "const d = arguments[0].discs; return [d.cases[d.number].theta, d.cells.wo[2]]"
    slider.send_keys(Keys.HOME)
    browser.settle()
    theta, z = browser.execute_script(place, holder)
    assert theta == 0 and abs(z - 1) < 1e-12
    slider.send_keys(Keys.END)
    browser.settle()
    theta, z = browser.execute_script(place, holder)
    assert theta == 60 and abs(z - 0.5) < 1e-12
    assert slider.get_attribute("aria-valuetext").startswith("θo 60°")


def test_two_sides_and_two_modes_have_choices(browser):
    browser.get(file_url("failing"))
    find = "return document.querySelector('[id^=s-rough-dielectric]').id"
    section = browser.execute_script(find)
    browser.get("about:blank")
    browser.get(file_url("failing", f"#{section}"))
    browser.settle()
    holder = discs(browser, section.replace(".", "\\."))
    assert len(holder.find_elements(By.CSS_SELECTOR, ".disc-row")) == 2, "front and back"
    place = "const d = arguments[0].discs; return [d.cases[d.number].theta, d.cases[d.number].transport]"
    seen = set()
    for choice in holder.find_elements(By.CSS_SELECTOR, "select[data-choice]"):
        for option in choice.find_elements(By.TAG_NAME, "option"):
            option.click()
            browser.settle()
            seen.add(tuple(browser.execute_script(place, holder)))
    assert {theta for theta, _ in seen} == {30, 150} and {mode for _, mode in seen} == {"radiance", "importance"}
    browser.picture("glass")


def test_a_narrow_lobe_is_shown_large(browser):
    browser.get(file_url("failing"))
    section = browser.execute_script(
        "return [...document.querySelectorAll('.subject')].find(s => s.textContent.includes('alpha=0.02')).id"
    )
    browser.get("about:blank")
    browser.get(file_url("failing", f"#{section}"))
    browser.settle()
    holder = discs(browser, section.replace(".", "\\."))
    script = "const d = arguments[0].discs; return [lobeWindow(d.cells, true, scales).half, d.cases[d.number].plot]"
    half, plot = browser.execute_script(script, holder)
    # The picture of the case, drawn by the library, has the same window.
    zoom = re.search(r"zoom ×([\d.]+) around", (PAGES / "failing" / plot).read_text())
    assert abs(float(zoom[1]) * half - 1) < 0.1, (zoom[1], half)
    browser.picture("narrow-lobe")


def test_cells_that_the_page_lacks_are_fetched_or_asked_for(browser):
    with served("detached") as address:
        browser.get(address)
        assert not browser.find_elements(By.CSS_SELECTOR, "script[data-cells]")
        # Nothing was there to be read: the page says so.
        assert "Not all evidence could be read" in browser.find_element(By.ID, FAILING).text
        got = browser.execute_async_script(
            """load({evidence: arguments[0]}, () => {}).then(c => arguments[1](c.observed.length), e => arguments[1](String(e)))""",
            "evidence/case-0000.json.gz",
        )
        assert isinstance(got, int) and got > 100
        lost = browser.execute_async_script(
            "load({evidence: 'evidence/case-9999.json.gz'}, () => {}).then(arguments[0], e => arguments[0](e.message))"
        )
        assert "is not there (404)" in lost
        browser.complaints()
    browser.get(file_url("detached"))
    asked = browser.execute_async_script(
        """let told = null;
        const done = arguments[0];
        load({evidence: 'evidence/case-0000.json.gz'}, question => { document.body.prepend(question); done(question.textContent); });"""
    )
    assert "Choose evidence/case-0000.json.gz" in asked
    chooser = browser.find_element(By.CSS_SELECTOR, "input[type=file]")
    chooser.send_keys(str(PAGES / "failing/evidence/case-0000.json.gz"))
    got = browser.execute_async_script("loaded; load({evidence: 'x'}, () => {}); setTimeout(() => arguments[0](1), 300)")
    assert got == 1 and browser.complaints() == []
