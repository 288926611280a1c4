#!/usr/bin/env python3
"""Makes the pictures of README.md and docs/report.md again: docs/make_report_pictures.py build/bin/ricci

Each is a part of a page of `ricci report` about a surface of `ricci generate`, as a headless Chromium shows it. Needs what
the tests of the report need (chromium, chromium-driver, python3-selenium, python3-pil) and pngquant.
"""
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests/report"))
sys.dont_write_bytecode = True
from browser import Browser  # noqa: E402


def main():
    program, pictures = str(pathlib.Path(sys.argv[1]).resolve()), ROOT / "docs/pictures"
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)

        def ricci(*arguments):
            subprocess.run([program, *map(str, arguments)], cwd=folder, check=True, stdout=subprocess.DEVNULL)

        ricci("generate", "eight", "--faces", 5000, "-o", "eight.off")
        ricci("sweep", "eight.off", "-o", "eight.h5", "--quiet")
        ricci("report", "eight.h5", "-o", "eight.html")
        ricci("layout", "eight.off", "--quality", "-o", "structure.h5")
        ricci("report", "structure.h5", "-o", "structure.html")
        browser = Browser(folder / "chromium")

        def keep(name, page, width, part, prepare=""):
            browser.size(width, 1200)
            browser.open(folder / page)
            browser.show("figure.view")
            browser.run(prepare)
            browser.show("figure.view")
            browser.picture(part).save(folder / f"{name}.png")
            subprocess.run(["pngquant", "--force", "--speed", "1", "--strip", "--output", str(pictures / f"{name}.png"), "160",
                            str(folder / f"{name}.png")], check=True)
            print(name, (pictures / f"{name}.png").stat().st_size)

        try:
            keep("report_sweep", "eight.html", 1360, "article .grid",
                 "const f = document.querySelector('figure.view'); f.view.pickVertex(f.view.d.marks[0].vertex);")
            keep("report_structure", "structure.html", 1000, "article .grid",
                 "const f = document.querySelector('figure.view'), last = f.view.layers.length - 1;"
                 "f.view.chooser.selectedIndex = last; f.view.show(last); f.view.pickVertex(300);"
                 # The view and the domain alone.
                 "[...document.querySelectorAll('article .grid > *')].forEach((e, k) => { if (k === 1 || k === 2 || k === 4) e.remove(); });")
        finally:
            browser.close()


if __name__ == "__main__":
    main()
