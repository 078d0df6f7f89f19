"""A headless Chromium for the tests of pages, and a server of their own."""

import contextlib
import functools
import http.server
import json
import os
import pathlib
import tempfile
import threading

from selenium import webdriver

# Made by tests/browser.rs.
PAGES = pathlib.Path(os.environ["GONIO_PAGES"])
SCREENSHOTS = pathlib.Path(os.environ["GONIO_SCREENSHOTS"])

SWITCHES = [
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
]


class Browser(webdriver.Chrome):
    """Chromium with a profile of its own; ends with the `with` that began it."""

    def __init__(self, width=1280, height=900, dark=False):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        options = webdriver.ChromeOptions()
        for switch in [*SWITCHES, f"--user-data-dir={self.profile.name}"]:
            options.add_argument(switch)
        options.binary_location = "/usr/bin/chromium"
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        super().__init__(options=options, service=webdriver.ChromeService("/usr/bin/chromedriver"))
        # Others use the machine too.
        self.set_script_timeout(90)
        self.resize(width, height)
        self.media([{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def __exit__(self, *of):
        super().__exit__(*of)
        self.profile.cleanup()

    def resize(self, width, height):
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)

    def media(self, features=(), kind=""):
        self.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": kind, "features": list(features)})

    def settle(self):
        """Waits until the page has drawn what it was asked for."""
        self.execute_async_script(
            "const done = arguments[0]; setTimeout(() => requestAnimationFrame(() => setTimeout(done, 0)), 150);"
        )

    def picture(self, name):
        self.settle()
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        self.save_screenshot(str(SCREENSHOTS / f"{name}.png"))

    def complaints(self):
        """What the page wrote to the console: errors, and breaches of its policy."""
        return [entry["message"] for entry in self.get_log("browser")]

    def requests(self):
        """The addresses that were asked for."""
        events = (json.loads(entry["message"])["message"] for entry in self.get_log("performance"))
        return [
            event["params"]["request"]["url"]
            for event in events
            if event["method"] == "Network.requestWillBeSent"
        ]


def file_url(folder, fragment=""):
    return (PAGES / folder / "index.html").as_uri() + fragment


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@contextlib.contextmanager
def served(folder):
    """The address of a page over HTTP."""
    handler = functools.partial(Quiet, directory=str(PAGES / folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/index.html"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
