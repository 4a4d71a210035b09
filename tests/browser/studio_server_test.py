#!/usr/bin/env python3
"""Starts `motionlang studio`, attacks it, and uses its page in Chromium. Only Python's own library.

    studio_server_test.py <chromedriver> <program motionlang> <folder>

Exit status: 0 passed, 1 failed, 77 skipped because the program has no server.
"""
import base64
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import threading
import time

from pages_test import wait
from studio_edit_test import drop, picture
from studio_test import CONTROL, ENTER, MADE, click, expect, made, press, state, type_into, write
from viewer_test import WEBGL, Browser, severe, start_driver

CLIENT = "0123456789abcdef" * 2


class Server:
    def __init__(self, program, project):
        self.process = subprocess.Popen([program, "studio", "--port", "0", "--project", str(project)],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/#token=([0-9a-f]{32})$", line.strip())
        if not found:
            raise RuntimeError(line + self.process.stderr.read())
        self.port, self.token, self.link = int(found.group(1)), found.group(2), found.group(0)
        self.host = f"127.0.0.1:{self.port}"

    def alive(self):
        return self.process.poll() is None

    def connect(self, timeout=60):
        return socket.create_connection(("127.0.0.1", self.port), timeout)

    def send(self, data, timeout=60):
        """What the server answers to these bytes, until it closes."""
        with self.connect(timeout) as s:
            try:
                s.sendall(data)
            except OSError:
                pass  # it closed before it read all
            out = b""
            try:
                while block := s.recv(65536):
                    out += block
            except OSError:
                pass
            return out

    def request(self, method="POST", path="/ask", body=b"", **fields):
        head = {"Host": self.host, "Content-Type": "application/json", "X-Motionlang-Token": self.token,
                "Content-Length": str(len(body))}
        head.update({k.replace("_", "-"): v for k, v in fields.items()})
        lines = [f"{method} {path} HTTP/1.1"] + [f"{k}: {v}" for k, v in head.items() if v is not None]
        return self.send("\r\n".join(lines).encode() + b"\r\n\r\n" + body)

    def ask(self, question, **fields):
        """The last line of an answer; None if it is refused."""
        answer = self.request(body=json.dumps({"client": CLIENT, **question}).encode(), **fields)
        if status(answer) != 200:
            return None
        lines = re.findall(rb"^\{.*\}\r?$", answer, re.MULTILINE)
        return json.loads(lines[-1]) if lines else None


def status(answer):
    return int(answer.split(b" ", 2)[1]) if answer.startswith(b"HTTP/1.1 ") else 0


def heads(server, problems):
    """Wrong names, origins, tokens, methods, paths."""
    def refused(what, wanted, answer):
        expect(problems, f"{what}: {status(answer)}, not {wanted}",
               status(answer) == wanted and server.token.encode() not in answer and b"root:" not in answer)

    expect(problems, "a good question is refused", "value" in (server.ask({"kind": "load"}) or {}))
    page = server.request("GET", "/")
    expect(problems, f"no page: {status(page)}", status(page) == 200 and b"<title>motionlang studio" in page)
    expect(problems, "the page has the token", server.token.encode() not in page)
    for name in (b"X-Frame-Options: DENY", b"frame-ancestors 'none'", b"X-Content-Type-Options: nosniff",
                 b"Cross-Origin-Resource-Policy: same-origin", b"Referrer-Policy: no-referrer"):
        expect(problems, f"no {name.decode()}", name in page)
    expect(problems, "it allows other origins", b"Access-Control" not in page)
    load = json.dumps({"kind": "load", "client": CLIENT}).encode()
    for host in ("evil.example", f"evil.example:{server.port}", "127.0.0.1", "", None):
        refused(f"Host {host}", 400 if host is None else 421, server.request(body=load, Host=host)) \
            if host is not None else expect(problems, "no Host", status(server.request(body=load, Host=None)) in (400, 421))
        if host:
            refused(f"the page for Host {host}", 421, server.request("GET", "/", Host=host))
    for origin in ("http://evil.example", "null", f"https://{server.host}", f"http://localhost:{server.port}"):
        refused(f"Origin {origin}", 403, server.request(body=load, Origin=origin))
    refused("another site", 403, server.request(body=load, Sec_Fetch_Site="cross-site"))
    for token in (None, "", "0" * 32, server.token[:-1], server.token + "0"):
        refused(f"token {token}", 401, server.request(body=load, X_Motionlang_Token=token))
    refused("a form", 415, server.request(body=load, Content_Type="text/plain"))
    for method in ("GET", "PUT", "DELETE", "OPTIONS", "PATCH"):
        refused(method, 405, server.request(method, body=load))
    refused("preflight", 405, server.request("OPTIONS", "/ask", Origin=f"http://{server.host}",
                                             Access_Control_Request_Method="POST"))
    for path in ("/etc/passwd", "/../../etc/passwd", "/..%2f..%2fetc/passwd", "/%2e%2e/%2e%2e/etc/passwd",
                 "//etc/passwd", "/studio.html", "/./", "/ask/../../etc/passwd"):
        refused(path, 404, server.request("GET", path))


def files(server, folder, project, problems):
    """No file outside of the project is read or written."""
    secret = folder / "secret.txt"
    secret.write_text("secret", encoding="utf-8")
    (project / "link.txt").symlink_to(secret)
    for name in ("../secret.txt", str(secret), "link.txt", "..\\secret.txt", "a/../../secret.txt", ".txt", "x\0.txt",
                 "/dev/zero", "CON.txt/../x.txt"):
        for question in ({"kind": "open", "name": name}, {"kind": "store", "name": name, "bytes": "bG9zdA=="}):
            answer = server.ask(question)
            expect(problems, f"{question}: {answer}", answer and "error" in answer)
    expect(problems, "the secret is lost", secret.read_text(encoding="utf-8") == "secret")
    expect(problems, "a file is somewhere else", sorted(p.name for p in project.iterdir()) == ["link.txt"])
    mark = ((server.ask({"kind": "store", "name": "a.txt", "bytes": "aGk="}) or {}).get("value") or {}).get("mark")
    expect(problems, f"store: {mark}", mark)
    lost = server.ask({"kind": "store", "name": "a.txt", "bytes": "bG9zdA==", "over": "0" * 16})
    expect(problems, f"contents that nobody read are overwritten: {lost}", lost == {"value": {"mark": None}})
    expect(problems, "files", server.ask({"kind": "files"}) == {"value": ["a.txt"]})
    expect(problems, "open", server.ask({"kind": "open", "name": "a.txt"}) ==
           {"value": {"bytes": "aGk=", "mark": mark}})


def endless(server, begin, block):
    """Sends a block again and again, up to 200 MiB. The bytes of the blocks that the server took."""
    sent = 0
    with server.connect() as s:
        try:
            s.sendall(begin)
            while sent < 200 << 20:
                s.sendall(block)
                sent += len(block)
        except OSError:
            pass
    return sent


def bodies(server, problems):
    """Malformed, oversized, endless and slow bodies."""
    for body in (b"", b"{", b"[" * 100000, b"nul", b'{"kind":"load"', b"\xff\xfe", b'{"kind":"load","client":"x"}',
                 b'{"a":' * 5000, json.dumps({"kind": "generate", "client": CLIENT, "timeline": "x" * 200000}).encode()):
        answer = server.request(body=body)
        expect(problems, f"{body[:20]}: {answer[:80]}", status(answer) in (200, 400) and
               (status(answer) == 400 or b'"error"' in answer))
    large = server.request(Content_Length=str(10 ** 12))
    expect(problems, f"a large body: {large[:40]}", status(large) in (0, 413))
    head = (f"POST /ask HTTP/1.1\r\nHost: {server.host}\r\nContent-Type: application/json\r\n"
            f"X-Motionlang-Token: {server.token}\r\nTransfer-Encoding: chunked\r\n\r\n").encode()
    sent = endless(server, head, b"100000\r\n" + b"x" * 0x100000 + b"\r\n")  # chunks: it closes after 48 MiB
    expect(problems, f"it read {sent >> 20} MiB of an endless body", sent < 120 << 20)
    sent = endless(server, b"GET / HTTP/1.1\r\nA: ", b"x" * 0x10000)  # a line: it closes after 64 KiB
    expect(problems, f"it read {sent >> 20} MiB of an endless head", sent < 20 << 20)
    for data in (b"\0" * 1000, b"GET " + b"/" * 100000 + b" HTTP/1.1\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n",
                 b"GET / HTTP/1.1\r\n" + b"A: " + b"b" * 100000 + b"\r\n\r\n", b"\r\n\r\n", b"POST /ask\r\n\r\n"):
        expect(problems, f"{data[:20]} gets {status(server.send(data))}", status(server.send(data)) != 200)
    expect(problems, "a second request in a refused body is answered",
           server.request(body=b"GET / HTTP/1.1\r\nHost: " + server.host.encode() + b"\r\n\r\n",
                          X_Motionlang_Token="0").count(b"HTTP/1.1 ") == 1)
    expect(problems, "it is down", server.alive())


def crowd(server, problems):
    """A hundred connections that say nothing, or little, keep nobody waiting."""
    idle = [server.connect() for _ in range(100)]
    try:
        for s in idle[:50]:
            s.sendall(b"POST /ask HTTP/1.1\r\nHost: ")
        began = time.monotonic()
        answer = server.ask({"kind": "load"})
        took = time.monotonic() - began
        print(f"beside a hundred idle connections an answer takes {took:.2f} s")
        expect(problems, f"beside a hundred connections: {answer} after {took:.1f} s", answer and took < 5)
    finally:
        for s in idle:
            s.close()
    answers = [None] * 100

    def ask(i):
        answers[i] = server.ask({"kind": "check", "timeline": f"walk # 0 # {i % 5 + 1}\n", "client": f"{i:032x}"})

    threads = [threading.Thread(target=ask, args=(i,)) for i in range(100)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    right = sum(a is not None and a.get("value", {}).get("seconds") == i % 5 + 1 for i, a in enumerate(answers))
    expect(problems, f"{right} of 100 questions at once have their answer", right == 100)


def slow_heads(server, problems, stated=10):
    """A hundred connections that send a byte a second are cut in the stated time, and others are served."""
    line = f"POST /ask HTTP/1.1\r\nHost: {server.host}\r\nX-Slow: ".encode() + b"a" * 1000
    slow = {server.connect(): None for _ in range(100)}  # when it was cut
    began, longest, asked = time.monotonic(), 0.0, 0
    try:
        for s in slow:
            s.setblocking(False)
        for at in range(3 * stated):
            for s in [s for s, cut in slow.items() if cut is None]:
                try:
                    s.send(line[at:at + 1])
                    open_still = s.recv(4096) != b""
                except BlockingIOError:
                    open_still = True
                except OSError:
                    open_still = False
                if not open_still:
                    slow[s] = time.monotonic() - began
            if None not in slow.values():
                break
            before = time.monotonic()
            answer = server.ask({"kind": "load"})
            longest, asked = max(longest, time.monotonic() - before), asked + 1
            expect(problems, f"beside slow senders: {answer}", answer and "value" in answer)
            time.sleep(max(0.0, began + at + 1 - time.monotonic()))
    finally:
        for s in slow:
            s.close()
    left = sum(cut is None for cut in slow.values())
    last = max((cut for cut in slow.values() if cut is not None), default=0)
    print(f"100 connections with a byte a second: {100 - left} are cut, the last after {last:.1f} s; {asked} other "
          f"questions took at most {longest:.2f} s")
    expect(problems, f"{left} slow connections stay", left == 0)
    expect(problems, f"slow connections are cut after {last} s, not {stated}", stated - 1 < last < stated + 4)
    expect(problems, f"beside slow senders an answer takes {longest} s", longest < 3)
    patient = (f"GET / HTTP/1.1\r\nHost: {server.host}\r\n\r\n").encode()  # two thirds of the time is not too slow
    with server.connect() as s:
        for part in range(4):
            s.sendall(patient[part * len(patient) // 4:(part + 1) * len(patient) // 4])
            time.sleep(stated / 6)
        expect(problems, "a head that takes two thirds of the time is refused", s.recv(12).startswith(b"HTTP/1.1 200"))


def slow_bodies(server, problems, stated=30):
    """A body that comes slowly is cut, too."""
    head = (f"POST /ask HTTP/1.1\r\nHost: {server.host}\r\nContent-Type: application/json\r\n"
            f"X-Motionlang-Token: {server.token}\r\nContent-Length: 1000\r\n\r\n").encode()
    began = time.monotonic()
    with server.connect() as s:
        s.sendall(head)
        s.settimeout(1)
        out = None
        while out is None and time.monotonic() - began < 2 * stated:
            try:
                s.sendall(b" ")
                out = s.recv(100)
            except TimeoutError:
                pass
            except OSError:
                out = b""
    took = time.monotonic() - began
    print(f"a body with a byte a second is cut after {took:.1f} s")
    expect(problems, f"a slow body is cut after {took} s", stated - 1 < took < stated + 4)


def leaving(server, problems):
    """Who leaves ends the work: the next question hardly waits for it."""
    def timed(seed):
        """The seconds of a short motion, as each seed is made anew."""
        began = time.monotonic()
        answer = server.ask({"kind": "generate", "timeline": "walk # 0 # 2\n", "seed": seed, "fast": True})
        expect(problems, f"no motion: {answer}", answer and "value" in answer)
        return time.monotonic() - began

    timed(1)  # the first one reads what the others have
    alone = timed(2)
    body = json.dumps({"client": CLIENT, "kind": "generate", "timeline": "walk # 0 # 100\n"}).encode()
    for _ in range(4):
        with server.connect() as s:
            s.sendall(f"POST /ask HTTP/1.1\r\nHost: {server.host}\r\nContent-Type: application/json\r\n"
                      f"X-Motionlang-Token: {server.token}\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body)
            s.recv(1000)
    after = timed(3)
    # The four motions have 400 times the work of the short one; each may end the step that it is in, a twentieth.
    print(f"a short motion takes {alone:.2f} s alone and {after:.2f} s after four that nobody wants")
    expect(problems, f"{after:.2f} s after four motions that nobody wants, {alone:.2f} s alone", after < 60 * alone)


def searching(browser, problems):
    """Words find a moment in the project's folder, which becomes a bar that is kept."""
    whole = state(browser)["whole"]
    click(browser, "#find")
    type_into(browser, "#sought", "walk backwards" + ENTER)
    expect(problems, "nothing is found: " + browser.run("return document.getElementById('findSays').textContent"),
           wait(browser, "document.querySelectorAll('#found li').length > 0", 60))
    picture(browser, "found")
    click(browser, "#found button")
    expect(problems, "what was found is not on the timeline", wait(
        browser, "motionlang.state().project.bars.some((b) => b.clip && /^walk_backwards/.test(b.text)) && "
        "!document.getElementById('findDialog').open", 20))
    clip = [b for b in state(browser)["project"]["bars"] if b.get("clip")][0]
    expect(problems, f"the moment: {clip}", 0.9 < clip["end"] - clip["start"] < 3.1 and clip["whole"] > 2)
    count = state(browser)["motions"]
    click(browser, "#generate")
    keeps = made(browser, count + 1)
    expect(problems, "no motion that keeps it: " +
           browser.run("return document.getElementById('status').textContent"), keeps)
    press(browser, CONTROL, "z")
    expect(problems, "undo does not take it off", wait(browser, "!motionlang.state().stale", 10) and
           state(browser)["whole"]["timelines"] == whole["timelines"])


def status_of(browser):
    return browser.run("return document.getElementById('status').textContent")


def save_project(browser, name, problems):
    """Saves the project and expects its name. A motion that is made would speak last."""
    wait(browser, "!motionlang.state().making", MADE)
    browser.run("document.getElementById('status').textContent = ''")
    click(browser, "#saveProject")
    said = wait(browser, "/ is in/.test(document.getElementById('status').textContent)", 20)
    answer = status_of(browser)
    expect(problems, f"{answer}, and not {name}", said and answer.startswith(f"{name} is in"))


def reload(browser):
    browser.run("window.before = 1; setTimeout(() => location.reload(), 0)")
    wait(browser, "!window.before && window.motionlang && motionlang.state().motions > 0 && "
         "!motionlang.state().making", MADE)


def set_seed(browser, seed):
    write(browser, "#seed", f"{seed}" + ENTER)
    wait(browser, f"motionlang.state().project.seed === {seed} && !motionlang.state().making", MADE)


def names_of_projects(browser, server, project, problems):
    """A project is saved where it was opened or saved before, also after a reload, unless somebody else wrote there."""
    first, second = (project / f"walk_backwards_project{n}.json" for n in ("", "_2"))
    seeds = lambda path: [p["seed"] for p in json.loads(path.read_text(encoding="utf-8"))["timelines"]]
    set_seed(browser, 97)
    save_project(browser, first.name, problems)
    expect(problems, "after a reload it is not saved where it was", seeds(first) == [97])
    expect(problems, "it does not say where it saves", first.name in browser.run(
        "return document.getElementById('saveProject').title"))
    words = first.read_bytes().replace(b": 97", b": 55")
    answer = server.ask({"kind": "store", "name": first.name, "bytes": base64.b64encode(words).decode()})
    expect(problems, f"another client cannot write: {answer}", answer["value"]["mark"])
    reload(browser)
    save_project(browser, second.name, problems)
    expect(problems, "it does not say why it is another file", first.name in status_of(browser))
    save_project(browser, second.name, problems)
    expect(problems, "the file of another client is overwritten", first.read_bytes() == words)
    browser.run(f"const list = document.getElementById('folder'); list.value = {json.dumps(first.name)};"
                "list.dispatchEvent(new Event('change'))")
    expect(problems, "a project of the folder is not opened", wait(
        browser, "/Undo brings back/.test(document.getElementById('status').textContent)", 20))
    wait(browser, "!motionlang.state().making", MADE)
    set_seed(browser, 99)
    save_project(browser, first.name, problems)
    expect(problems, "it is not saved where it was opened", seeds(first) == [99])
    while state(browser)["undos"]:
        press(browser, CONTROL, "z")
    save_project(browser, second.name, problems)
    expect(problems, "undo of opening overwrites what was opened", seeds(first) == [99] and seeds(second) == [97])
    wait(browser, "!motionlang.state().making", MADE)
    click(browser, ".bar[data-bar='0']")
    write(browser, "#words", "sit down")
    reload(browser)
    save_project(browser, second.name, problems)
    expect(problems, "with another first text it has another file", json.loads(second.read_text(encoding="utf-8"))[
        "timelines"][0]["bars"][0]["text"] == "sit down" and not list(project.glob("sit*")))
    click(browser, ".bar[data-bar='0']")
    write(browser, "#words", "walk backwards")
    second.unlink()
    save_project(browser, second.name, problems)  # nothing is lost by that
    wait(browser, "!motionlang.state().making", MADE)


def cancelled_save(browser, server, project, problems):
    """A save that arrives, but whose answer does not, is known again: the next one goes to the same file."""
    wait(browser, "!motionlang.state().making", MADE)
    click(browser, "#fresh")
    made(browser, state(browser)["motions"])
    wait(browser, "!motionlang.state().making && !motionlang.state().stale", MADE)
    while state(browser)["timelines"] > 1:  # a project that has no file yet
        click(browser, "#sheet option[value='0']")
        click(browser, "#drop")
    click(browser, ".bar[data-bar='0']")
    write(browser, "#words", "turn left")
    name = "turn_left_project.json"
    lose = ("window.asked = fetch; window.fetch = async (to, about) => { const answer = await asked(to, about);"
            "if (JSON.parse(about.body).kind !== 'store') return answer;"
            "throw new TypeError('the answer is lost'); }")
    for round in range(2):  # a new file, and one that is there
        time.sleep(1)  # until it is stored and checked
        set_seed(browser, 300 + round)
        browser.run(lose)
        click(browser, "#saveProject")
        wait(browser, "/does not answer/.test(document.getElementById('status').textContent)", 20)
        browser.run("window.fetch = asked")
        expect(problems, f"round {round}: it did not arrive", json.loads((project / name).read_text(
            encoding="utf-8"))["timelines"][0]["seed"] == 300 + round)
        set_seed(browser, 400 + round)
        save_project(browser, name, problems)
        expect(problems, f"round {round}: the save after that is elsewhere: {status_of(browser)}", json.loads((
            project / name).read_text(encoding="utf-8"))["timelines"][0]["seed"] == 400 + round and
            not list(project.glob("turn_left_project_*")))
    browser.run(lose)
    click(browser, "#saveProject")
    wait(browser, "/does not answer/.test(document.getElementById('status').textContent)", 20)
    browser.run("window.fetch = asked")
    words = (project / name).read_bytes().replace(b": 401", b": 55")  # somebody else writes there
    server.ask({"kind": "store", "name": name, "bytes": base64.b64encode(words).decode()})
    save_project(browser, "turn_left_project_2.json", problems)
    expect(problems, "what somebody else wrote is lost", (project / name).read_bytes() == words)


def refused_video(browser, folder, problems):
    """A video that the folder does not take becomes a download."""
    browser.post("/goog/cdp/execute", {"cmd": "Browser.setDownloadBehavior",
                                       "params": {"behavior": "allow", "downloadPath": str(folder)}})
    browser.run("window.asked = fetch; window.fetch = (to, about) => JSON.parse(about.body).kind === 'store' ? "
                "Promise.resolve(new Response('it is too large', { status: 413 })) : asked(to, about)")
    click(browser, "#kind option[value='.webm']")
    click(browser, "#save")
    expect(problems, "it does not say where the video is: " +
           browser.run("return document.getElementById('status').textContent"), wait(
               browser, "/among the downloads: .* it is too large/.test(document.getElementById('status').textContent)",
               60))
    video, end = folder / "turn_left.webm", time.monotonic() + 20  # of the project that was opened last
    while not video.exists() and time.monotonic() < end:
        time.sleep(0.1)
    expect(problems, "the video is lost", video.exists() and video.read_bytes().startswith(b"\x1aE\xdf\xa3"))
    browser.run("window.fetch = asked")


def in_browser(server, driver_port, project, problems):
    """The page makes a motion by the server, edits and saves it; another browser has its own."""
    first = second = None
    try:
        first = Browser(driver_port, [*WEBGL, "--window-size=1280,720"])
        first.post("/url", {"url": server.link})
        expect(problems, "no motion of the server", made(first, 1))
        now = state(first)
        print(f"from the server: first motion {now['opened']:.1f} s after opening, {now['took']:.1f} s to make it")
        expect(problems, f"{now['frames']} frames", now["frames"] == 120)
        address = first.run("return location.href")
        expect(problems, "the token stays in the address", server.token not in address)
        second = Browser(driver_port, [*WEBGL, "--window-size=1280,720"])
        second.post("/url", {"url": server.link})
        expect(problems, "no motion for the second browser", made(second, 1))
        other = second.run("return motionlang.turns()")
        click(first, ".bar[data-bar='0']")
        write(first, "#words", "walk backwards")
        click(first, "#generate")
        expect(problems, "no motion after an edit", made(first, 2))
        take = state(first)["takes"][state(first)["shown"]]
        expect(problems, f"nothing is reused: {take}", take["reuse"] and take["reuse"]["frames"] == 120)
        expect(problems, "the second browser's motion changed", second.run("return motionlang.turns()") == other)
        click(first, "#kind option[value='.bvh']")
        click(first, "#save")
        expect(problems, "the motion is not in the project",
               wait(first, "/folder/.test(document.getElementById('status').textContent)", 20) and
               (project / "walk_backwards.bvh").stat().st_size > 10000)
        click(first, "#saveProject")
        expect(problems, "the project's file is not in its folder", wait(
            first, "/_project.json is in/.test(document.getElementById('status').textContent)", 20) and json.loads(
                (project / "walk_backwards_project.json").read_text(encoding="utf-8")) == state(first)["whole"])
        searching(first, problems)
        first.post("/url", {"url": f"http://127.0.0.1:{server.port}/"})
        expect(problems, "a reload loses the token or the project",
               made(first, 1) and state(first)["project"]["bars"][0]["text"] == "walk backwards")
        names_of_projects(first, server, project, problems)
        cancelled_save(first, server, project, problems)
        refused_video(first, project.parent, problems)
        click(first, "#whole")
        wait(first, "document.getElementById('progress').value > 0", MADE)
        click(first, "#cancel")
        expect(problems, "it cannot be cancelled", wait(first, "!motionlang.state().making", 10))
        expect(problems, "the steps of another model",
               first.run("return document.getElementById('steps').options[0].text") == "as the model asks")
        named = project.parent / "Übung (1).BVH"
        named.write_bytes((project / "walk_backwards.bvh").read_bytes())
        drop(first, named)
        expect(problems, f"{named.name} is not kept: {first.run('return document.body.innerText')}",
               wait(first, "motionlang.state().project.bars.some((b) => b.clip && b.text === 'Übung (1)')", 20))
        first.run(f"window.before = 1; location.hash = 'token={server.token}'")
        expect(problems, "a link with a token does not reload the page",
               wait(first, "!window.before && window.motionlang && motionlang.state().motions > 0", MADE))
        for browser in (first, second):
            problems += [message for message in severe(browser) if "favicon" not in message]
        stranger = second
        stranger.post("/url", {"url": "about:blank"})
        stranger.post("/url", {"url": f"http://localhost:{server.port}/"})  # without a token
        expect(problems, "without a token it answers", wait(
            stranger, "/token/.test(document.getElementById('status').textContent)", 20))
    finally:
        for browser in (first, second):
            if browser:
                browser.close()


def main(driver_path, program, folder):
    folder = pathlib.Path(folder)
    project = folder / "project"
    project.mkdir()
    problems = []
    try:
        server = Server(program, project)
    except RuntimeError as reason:
        if "without cpp-httplib" in str(reason):
            print("skipped: this motionlang has no server")
            return 77
        raise
    driver, port = start_driver(driver_path)
    try:
        heads(server, problems)
        files(server, folder, project, problems)
        bodies(server, problems)
        crowd(server, problems)
        slow_heads(server, problems)
        slow_bodies(server, problems)
        leaving(server, problems)
        in_browser(server, port, project, problems)
        expect(problems, "it is down", server.alive())
        others = [pathlib.Path(p).name for p in pathlib.Path(os.environ.get("TMPDIR", "/tmp")).glob("motionlang-studio-*")]
        server.process.send_signal(signal.SIGINT)
        expect(problems, f"it does not end: {server.process.wait(60)}", server.process.returncode == 0)
        left = [name for name in others if (pathlib.Path(os.environ.get("TMPDIR", "/tmp")) / name).exists()]
        expect(problems, f"it leaves {left}", len(left) < len(others))
    finally:
        server.process.kill()
        driver.terminate()
    print(f"studio's server: {'; '.join(problems) or 'passed'}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
