#!/usr/bin/env python3
"""Opens GLB files in three.js in Chromium and looks at where the bones are. Only Python's own library.

    glb_test.py <chromedriver> <folder of three's package> <folder>

The folder holds expected.json, a list of {file, animation, samples: [{time, joints: {name: [x, y, z]}}]}, and the files.

    glb_test.py <chromedriver> <folder of three's package> <file.glb> <animation> <seconds> <picture.png>

writes a picture to look at. Exit status: 0 passed, 1 failed.
"""
import base64
import functools
import http.server
import json
import pathlib
import shutil
import sys
import tempfile
import threading
import time

from viewer_test import WEBGL, Browser, start_driver


class QuietHandler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def serve(folder):
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(QuietHandler, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


def call(browser, function, arguments):
    """The value of an asynchronous function of the page."""
    answer = browser.post("/execute/async", {"script": f"""
        const [arguments_, done] = arguments;
        window.{function}(...arguments_).then((value) => done({{value}}), (error) => done({{error: String(error)}}));
    """, "args": [arguments]})
    if "error" in answer:
        raise RuntimeError(answer["error"])
    return answer["value"]


def in_three(driver_path, three, folder, use):
    """What `use` returns of a browser with the page open; the files of `folder` are beside it."""
    with tempfile.TemporaryDirectory() as root:
        root = pathlib.Path(root)
        (root / "three").symlink_to(pathlib.Path(three).resolve())
        shutil.copy(pathlib.Path(__file__).with_name("glb_page.html"), root / "page.html")
        for file in pathlib.Path(folder).glob("*.glb"):
            (root / file.name).symlink_to(file.resolve())
        server = serve(root)
        driver, port = start_driver(driver_path)
        try:
            browser = Browser(port, WEBGL)
            try:
                browser.post("/url", {"url": f"http://127.0.0.1:{server.server_port}/page.html"})
                for _ in range(100):
                    if browser.run("return window.ready === true"):
                        break
                    time.sleep(0.1)
                return use(browser)
            finally:
                browser.close()
        finally:
            driver.terminate()
            server.shutdown()


def check(driver_path, three, folder):
    passed = True

    def use(browser):
        nonlocal passed
        for expected in json.loads((pathlib.Path(folder) / "expected.json").read_text(encoding="utf-8")):
            result = call(browser, "check", [expected])
            passed = passed and not result["problems"]
            print(f"{expected['file']}: joints within {result['worst']:.2g} m over {result['moved']:.2f} m of movement; "
                  f"{'; '.join(result['problems']) or 'passed'}")

    in_three(driver_path, three, folder, use)
    return passed


def picture(driver_path, three, file, animation, seconds, out):
    file = pathlib.Path(file)
    url = in_three(driver_path, three, file.parent, lambda b: call(b, "picture", [file.name, animation, float(seconds)]))
    pathlib.Path(out).write_bytes(base64.b64decode(url.split(",")[1]))
    return True


if __name__ == "__main__":
    sys.exit(0 if (check if len(sys.argv) == 4 else picture)(*sys.argv[1:]) else 1)
