"""A headless Chromium without network that opens pages from the disk, and what its pictures look like.

Chromium runs in a user data folder of its own. The network is off twice: no name resolves, and the page is emulated to
be offline; every request that is tried is recorded all the same.
"""
import base64
import io
import json
import pathlib
import shutil

import numpy
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")


class Browser:
    def __init__(self, folder: pathlib.Path, width: int = 1100, height: int = 900):
        options = Options()
        options.binary_location = CHROMIUM
        for flag in ("--headless=new", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
                     "--disable-component-update", "--disable-sync", "--disable-extensions", "--disable-default-apps",
                     "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                     "--force-device-scale-factor=1", "--force-color-profile=srgb", "--host-resolver-rules=MAP * ~NOTFOUND",
                     f"--window-size={width},{height}", f"--user-data-dir={folder}"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(service=Service(DRIVER), options=options)
        self.driver.set_page_load_timeout(120)
        self.driver.set_script_timeout(120)
        self.driver.execute_cdp_cmd("Network.enable", {})
        self.driver.execute_cdp_cmd("Network.emulateNetworkConditions",
                                    {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0})

    def close(self):
        self.driver.quit()

    def size(self, width: int, height: int):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})

    def open(self, page: pathlib.Path):
        """Opens a page and waits until it says that it is ready."""
        self.messages()
        self.driver.get(page.resolve().as_uri())
        self.run_async("const done = arguments[arguments.length - 1];"
                       "const wait = () => document.documentElement.dataset.ready ? done() : setTimeout(wait, 20); wait();")

    def run(self, script: str, *arguments):
        return self.driver.execute_script(script, *arguments)

    def run_async(self, script: str, *arguments):
        return self.driver.execute_async_script(script, *arguments)

    def show(self, selector: str, number: int = 0):
        """Scrolls an element into sight and waits until its view, if it has one, is drawn."""
        self.run_async("""
            const done = arguments[arguments.length - 1];
            const found = document.querySelectorAll(arguments[0])[arguments[1]];
            found.scrollIntoView({block: 'start', behavior: 'instant'});
            const ready = () => (!found.dataset.scene || found.dataset.drawn) &&
                ![...found.querySelectorAll('[data-thumbnail]')].some((t) => !t.firstChild && t.getBoundingClientRect().top < innerHeight);
            const wait = () => ready() ? requestAnimationFrame(() => requestAnimationFrame(done)) : setTimeout(wait, 20);
            wait();""", selector, number)

    def messages(self):
        """What the console has said, and what was asked of any network, since the last call: (console, requests)."""
        console = [m for m in self.driver.get_log("browser") if m["level"] in ("SEVERE", "WARNING")]
        requests = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                requests.append(message["params"]["request"]["url"])
        return console, requests

    def picture(self, selector: str, number: int = 0) -> Image.Image:
        """A screenshot of an element."""
        self.show(selector, number)
        box = self.run("const b = document.querySelectorAll(arguments[0])[arguments[1]].getBoundingClientRect();"
                       "return [b.left + scrollX, b.top + scrollY, b.width, b.height];", selector, number)
        shot = self.driver.execute_cdp_cmd("Page.captureScreenshot", {
            "format": "png", "captureBeyondViewport": True,
            "clip": {"x": box[0], "y": box[1], "width": box[2], "height": box[3], "scale": 1}})
        return Image.open(io.BytesIO(base64.b64decode(shot["data"]))).convert("RGB")

    def pixels(self, number: int = 0) -> numpy.ndarray:
        """What a view's canvas shows, (height, width, 3)."""
        self.show("figure.view", number)
        url = self.run("return document.querySelectorAll('figure.view canvas')[arguments[0]].toDataURL();", number)
        return numpy.asarray(Image.open(io.BytesIO(base64.b64decode(url.split(",")[1]))).convert("RGB"))
