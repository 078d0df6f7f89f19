"""2000 subjects of 12 checks."""

import time

from browser import Browser, file_url
from selenium.webdriver.common.by import By

# From the click on the page to a filtered table.
SECONDS = 2.0


def opened(browser):
    """Seconds to load and to filter: by the clock, and of a processor on the page's thread."""
    browser.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
    begun = time.monotonic()
    browser.get(file_url("large"))
    browser.execute_async_script(
        """const done = arguments[0];
        document.querySelector('input[name=verdict][value=fail]').click();
        requestAnimationFrame(() => setTimeout(done, 0));"""
    )
    clock = time.monotonic() - begun
    metrics = browser.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
    return clock, next(m["value"] for m in metrics if m["name"] == "TaskDuration")


def test_opens_and_filters_in_time():
    times = []
    for _ in range(3):
        with Browser() as browser:
            times.append(opened(browser))
            assert browser.find_element(By.ID, "shown").text == "40 of 2000 subjects"
    told = ", ".join(f"{clock:.2f} s ({processor:.2f} s of a processor)" for clock, processor in times)
    print("loaded and filtered in", told)
    # What the page costs; the clock goes on while a busy machine works for others.
    assert min(processor for _, processor in times) < SECONDS, told


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
