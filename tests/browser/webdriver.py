"""A browser without a window, driven over WebDriver (W3C) with nothing but Python's standard library."""

import base64
import json
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request


class Browser:
    """Headless Chromium through chromedriver; no network is used but localhost."""

    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix="rigfit-browser-")
        self.port = self._free_port()
        self.url = "http://127.0.0.1:%d" % self.port
        self.driver = subprocess.Popen(
            [shutil.which("chromedriver") or "chromedriver", "--port=%d" % self.port],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            self._wait_until_ready()
            arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                         "--disable-background-networking", "--disable-component-update", "--disable-sync",
                         "--disable-dev-shm-usage", "--hide-scrollbars", "--user-data-dir=" + self.profile,
                         "--window-size=1280,900"]
            options = {"args": arguments}
            binary = shutil.which("chromium")
            if binary:
                options["binary"] = binary
            self.session = "/session/" + self._new_session(options)["sessionId"]
        except Exception:
            self.close()
            raise

    def _new_session(self, options):
        """A browser may take longer to start on a busy machine than its driver waits: three tries."""
        wanted = {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}}
        for last in (False, False, True):
            try:
                return self._call("POST", "/session", wanted)
            except RuntimeError as error:
                if last or "session not created" not in str(error):
                    raise

    @staticmethod
    def _free_port():
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            return probe.getsockname()[1]

    def _wait_until_ready(self):
        end = time.monotonic() + 60
        while time.monotonic() < end and self.driver.poll() is None:
            try:
                if self._call("GET", "/status")["ready"]:
                    return
            except OSError:
                time.sleep(0.05)
        raise RuntimeError("chromedriver did not start")

    def _call(self, method, path, body=None):
        data = json.dumps(body).encode() if body is not None else None
        request = urllib.request.Request(self.url + path, data, {"Content-Type": "application/json"}, method=method)
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        try:
            with opener.open(request, timeout=120) as answer:
                return json.loads(answer.read())["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(error.read().decode()[:2000]) from None

    def open(self, url):
        self._call("POST", self.session + "/url", {"url": url})

    def run(self, script, *arguments):
        """What the script returns; `await` works in it."""
        wrapped = ("const done = arguments[arguments.length - 1], args = Array.from(arguments).slice(0, -1);"
                   "(async function() {" + script + "}).apply(null, args).then(done, e => done({error: String(e)}));")
        result = self._call("POST", self.session + "/execute/async", {"script": wrapped, "args": list(arguments)})
        if isinstance(result, dict) and set(result) == {"error"}:
            raise RuntimeError(result["error"])
        return result

    def console(self):
        """Entries since the last call, as dictionaries with `level` and `message`."""
        return self._call("POST", self.session + "/se/log", {"type": "browser"})

    def element(self, css):
        found = self._call("POST", self.session + "/element", {"using": "css selector", "value": css})
        return list(found.values())[0]

    def drag(self, css, from_x, to_x):
        """A drag over an element, horizontal, in pixels from its centre."""
        origin = {"element-6066-11e4-a52e-4f735466cecf": self.element(css)}
        move = lambda x, ms: {"type": "pointerMove", "duration": ms, "origin": origin, "x": x, "y": 0}
        self._call("POST", self.session + "/actions", {"actions": [{
            "type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": [
                move(from_x, 0), {"type": "pointerDown", "button": 0}, move((from_x + to_x) // 2, 60),
                move(to_x, 60), {"type": "pointerUp", "button": 0}]}]})

    def key(self, key):
        """Presses and lets go of a key (WebDriver's code points: \\ue004 is Tab)."""
        self._call("POST", self.session + "/actions", {"actions": [{
            "type": "key", "id": "keyboard", "actions": [{"type": "keyDown", "value": key},
                                                         {"type": "keyUp", "value": key}]}]})

    def screenshot(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self._call("GET", self.session + "/screenshot")))

    def pdf(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self._call("POST", self.session + "/print", {
                "background": True, "page": {"width": 21.0, "height": 29.7}})))

    def media(self, name, value):
        """Pretends a media feature, such as prefers-color-scheme: dark."""
        self.devtools("Emulation.setEmulatedMedia", features=[{"name": name, "value": value}])

    def devtools(self, command, **parameters):
        """A command of the Chrome DevTools Protocol."""
        return self._call("POST", self.session + "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def accessibility_tree(self):
        """What a screen reader is told: (role, name, properties) of every node, in order of the page."""
        nodes = self.devtools("Accessibility.getFullAXTree")["nodes"]
        known, told = {node["nodeId"]: node for node in nodes}, []
        value = lambda node, key: node.get(key, {}).get("value", "")

        def tell(node):
            if not node.get("ignored"):
                told.append((value(node, "role"), value(node, "name"),
                             {p["name"]: p["value"].get("value") for p in node.get("properties", [])}))
            for child in node.get("childIds", []):
                if child in known:
                    tell(known[child])

        tell(nodes[0])
        return told

    def close(self):
        if hasattr(self, "session"):
            try:
                self._call("DELETE", self.session)
            except (RuntimeError, OSError):
                pass
        self.driver.terminate()
        try:
            self.driver.wait(10)
        except subprocess.TimeoutExpired:
            self.driver.kill()
            self.driver.wait()
        shutil.rmtree(self.profile, ignore_errors=True)
