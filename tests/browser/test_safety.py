"""Hostile names do nothing, and nothing comes from a network."""

import pytest
from browser import Browser, file_url, served
from selenium.webdriver.common.by import By


def read_all(browser):
    """Opens and shows everything that there is."""
    browser.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")
    browser.settle()
    height = browser.execute_script("return document.documentElement.scrollHeight")
    for y in range(0, min(height, 20_000), 700):
        browser.execute_script(f"scrollTo(0, {y})")
        browser.settle()


@pytest.mark.parametrize("folder", ["failing", "hostile"])
@pytest.mark.parametrize("over_http", [False, True])
def test_nothing_but_the_page_is_asked_for(folder, over_http):
    with served(folder) as address, Browser() as browser:
        browser.get(address if over_http else file_url(folder))
        read_all(browser)
        own = address.rsplit("/", 1)[0] if over_http else file_url(folder)
        # The browser's own first page comes from itself.
        allowed = (own, "data:", "about:", "blob:", "chrome://")
        strangers = [url for url in browser.requests() if not url.startswith(allowed)]
        assert not strangers
        complaints = [c for c in browser.complaints() if "favicon" not in c]
        assert not complaints
        assert browser.execute_script("return window.hacked") is None


def test_hostile_names_are_shown_as_text():
    with Browser() as browser:
        browser.get(file_url("hostile"))
        name = "</script><script>window.hacked=1</script>"
        assert name in browser.find_element(By.CSS_SELECTOR, ".findings").text
        assert name in browser.find_element(By.CSS_SELECTOR, ".loud").text
        assert not browser.find_elements(By.CSS_SELECTOR, "img, [onerror], [onmouseover]")
        links = [a.get_attribute("href") for a in browser.find_elements(By.CSS_SELECTOR, "a[href]")]
        assert not [link for link in links if not link.startswith(("file:", "https:"))]
        scripts = browser.execute_script("return [...document.scripts].filter(s => !s.type).length")
        assert scripts == 1, "one script is the page's own"
        # Its section is found by its link all the same.
        browser.find_element(By.CSS_SELECTOR, ".findings a").click()
        browser.settle()
        assert browser.execute_script("return document.querySelector('.target').id").startswith("s-")
        browser.picture("hostile")
