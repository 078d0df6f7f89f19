"""2000 subjects of 12 checks."""

import time

from browser import Browser, file_url
from selenium.webdriver.common.by import By

# From the click on the page to a filtered table.
SECONDS = 2.0


def opened(browser):
    begun = time.monotonic()
    browser.get(file_url("large"))
    loaded = time.monotonic()
    browser.execute_async_script(
        """const done = arguments[0];
        const box = document.querySelector('input[name=verdict][value=fail]');
        box.click();
        requestAnimationFrame(() => setTimeout(done, 0));"""
    )
    return loaded - begun, time.monotonic() - begun


def test_opens_and_filters_in_time():
    times = []
    for _ in range(3):
        with Browser() as browser:
            times.append(opened(browser))
            shown = browser.find_element(By.ID, "shown").text
            assert shown == "40 of 2000 subjects"
    print("loaded, and filtered:", [f"{a:.2f} s, {b:.2f} s" for a, b in times])
    # Others use the machine too: the best of three is the page's own time.
    assert min(whole for _, whole in times) < SECONDS, times


def test_a_section_that_passes_opens_at_once():
    with Browser() as browser:
        browser.get(file_url("large"))
        anchor = browser.execute_script("return document.querySelectorAll('#matrix tbody tr')[1500].dataset.section")
        begun = time.monotonic()
        browser.execute_script(f"location.hash = '{anchor}--energy'")
        while not browser.find_elements(By.ID, f"{anchor}--energy"):
            assert time.monotonic() - begun < SECONDS
        browser.settle()
        target = browser.find_element(By.CSS_SELECTOR, ".target")
        assert target.get_attribute("id") == f"{anchor}--energy"
        browser.picture("large")
