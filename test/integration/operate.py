#!/usr/bin/env python3
"""operate.py BIN_DIR SCENARIO: a page operates emulated vehicles over HTTP, with signed commands.

Starts `vantage up` and `vantage view --operate` on SCENARIO with new keys and `security: require`.
Requests that another site, a page without the key, or a second page could send are refused. The page
arms the vehicles, lets them take off, follow, hold and land; each vehicle confirms. When the page
falls silent in flight, the heartbeat ends and the vehicles land. The emergency stop of a page that
does not operate is confirmed by every vehicle. To be run in its own network: in_network.sh operate.py ...
"""

import http.client
import json
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time

URL = "udpm://239.255.76.67:7667?ttl=0"
PATIENCE_S = 60


class Page:
    """An operator page: sends requests as a browser does; reports its presence in a thread."""

    def __init__(self, host, key):
        self.host, self.key, self.token = host, key, ""
        self.is_present = False
        threading.Thread(target=self.report, daemon=True).start()

    def request(self, what, content=None, **changed):
        """Returns the status and the content of the answer. `changed` replaces headers; None removes one."""
        headers = {"Origin": f"http://{self.host}", "Content-Type": "application/json", "X-Vantage-Key": self.key,
                   "X-Vantage-Token": self.token}
        for name, value in changed.items():
            headers[name.replace("_", "-")] = value
        headers = {name: value for name, value in headers.items() if value is not None}
        link = http.client.HTTPConnection(self.host, timeout=10)
        link.request("POST", f"/api/operate/{what}", body=json.dumps(content or {}), headers=headers)
        answer = link.getresponse()
        text = answer.read().decode()
        link.close()
        return answer.status, json.loads(text) if text.startswith("{") else text

    def claim(self):
        status, content = self.request("claim")
        if status == 200:
            self.token = content["token"]
            self.is_present = True
        return status

    def report(self):
        while True:
            try:
                if self.is_present and not self.request("state")[1]["is_operator"]:
                    self.claim()  # a busy machine has delayed the reports, as the page does in this case
            except OSError:
                return  # the server has ended
            time.sleep(0.25)

    def station(self):
        status, content = self.request("state")
        assert status == 200, content
        return content["station"]

    def order(self, action, robot=""):
        return self.request("order", {"action": action, "robot": robot})[0]


def until(holds, what, patience_s=PATIENCE_S):
    give_up = time.monotonic() + patience_s
    while True:
        found = holds()
        if found:
            return found
        assert time.monotonic() < give_up, f"no {what}"
        time.sleep(0.1)


def states(page):
    return {each["robot"]: each["state"] for each in page.station()["vehicles"]}


def outcomes(page):
    return {name: (each["action"], each["outcome"]) for name, each in page.station()["receipts"].items()}


def check_refusals(page, host):
    for changed in ({"Origin": "http://evil.example"}, {"Origin": None}, {"Origin": f"http://localhost:{host.split(':')[1]}"},
                    {"Origin": "https://app.foxglove.dev"}, {"Host": "evil.example"}, {"X_Vantage_Key": "0" * 32},
                    {"X_Vantage_Key": None}):
        for what, content in (("claim", None), ("state", None), ("order", {"action": "estop", "robot": ""})):
            status, answer = page.request(what, content, **changed)
            assert status == 403, (changed, what, status, answer)
    assert page.request("claim", None, Content_Type="text/plain")[0] == 415
    assert page.request("order", {"action": "arm", "robot": "x" * 5000})[0] == 413
    link = http.client.HTTPConnection(host, timeout=10)
    link.request("GET", "/api/operate/state")
    assert link.getresponse().status == 405
    link.close()
    assert page.order("arm") == 409, "no claim"
    for content in ({}, {"action": "quit", "robot": ""}, {"action": "fly", "robot": ""}, {"action": 1, "robot": ""}):
        assert page.request("order", content)[0] == 400, content


def take_off(page):
    """Returns the vehicles in the air: all, or after PATIENCE_S at least one, because a busy host refuses arming and take-off."""
    until(lambda: page.station()["role"] == "in charge", "charge")
    give_up = time.monotonic() + PATIENCE_S
    while True:
        now = states(page)
        flying = [robot for robot, state in now.items() if state == "hold"]
        if len(flying) == len(now) or (flying and time.monotonic() > give_up):
            return flying
        assert time.monotonic() < give_up + PATIENCE_S, page.station()
        for robot, state in now.items():
            if state in ("idle", "killed"):
                page.order("arm", robot)
                page.order("take-off", robot)
        time.sleep(4.0)


def check_flight(page, other):
    until(lambda: set(states(page).values()) <= {"idle", "killed"} and len(states(page)) == 3, "vehicles")
    assert page.order("follow") == 200
    lines = until(lambda: [each["words"] for each in page.station()["journal"] if "no effect" in each["words"]], "refusal")
    assert re.search("not in operation|arm it first", lines[0]), lines
    flying = take_off(page)

    def confirmed(action, robots):
        """Gives an order until each vehicle confirms it: on a busy machine a vehicle may first have no plan to follow."""
        def is_confirmed():
            receipts = outcomes(page)
            for robot in robots:
                if receipts[robot] != (action, "confirmed"):
                    if receipts[robot] != (action, "awaited"):
                        assert page.order(action, robot) == 200
                    return False
            return True
        until(is_confirmed, f"{action} of {robots}")

    confirmed("follow", flying)
    confirmed("hold", flying[:1])
    confirmed("land", flying[:1])
    assert other.order("hold") == 409, "the other page does not operate"
    # The page falls silent: its heartbeat ends, and the vehicles in the air land.
    page.is_present = False
    until(lambda: all(state in ("land", "idle", "killed") for state in states(other).values()), "landing without an operator", 20)
    assert other.claim() == 200, "the other page takes over"
    assert page.order("follow") == 409
    until(lambda: set(states(other).values()) <= {"idle", "killed"}, "vehicles on the ground")
    # A page without the claim may stop all vehicles, and each confirms.
    assert page.order("estop") == 200
    until(lambda: set(outcomes(other).values()) == {("estop", "confirmed")}, "confirmed emergency stop", 5)
    assert set(states(other).values()) == {"killed"}
    return len(flying)


def main():
    binaries, scenario = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as folder:
        keys = f"{folder}/keys"
        subprocess.run([f"{binaries}/vantage", "keys", "new", keys], check=True, stdout=subprocess.DEVNULL)
        signed = pathlib.Path(f"{folder}/signed.yaml")
        signed.write_text(pathlib.Path(scenario).read_text(encoding="utf-8") + f"\nsecurity: {{mode: require, keys: {keys}}}\n",
                          encoding="utf-8")
        refused = subprocess.run([f"{binaries}/vantage", "view", "--operate", "--bind", "0.0.0.0", "--port", "0", "--url", URL],
                                 capture_output=True, text=True, check=False)
        assert refused.returncode != 0 and "--host NAME" in refused.stderr, refused
        with open(f"{folder}/view.out", "w", encoding="utf-8") as out, open(f"{folder}/up.err", "w", encoding="utf-8") as errors:
            view = subprocess.Popen([f"{binaries}/vantage", "view", "--operate", "--scenario", str(signed), "--url", URL,
                                     "--port", "0"], stdout=out)
            up = subprocess.Popen([f"{binaries}/vantage", "up", str(signed), "--url", URL, "--no-log", "--json", "--ignore-load"],
                                  stdout=errors, stderr=errors)
            try:
                host, key = until(lambda: re.findall(r"http://([\d.:]+)/#operate=([0-9a-f]{32})",
                                                     pathlib.Path(f"{folder}/view.out").read_text(encoding="utf-8")), "address")[0]
                page, other = Page(host, key), Page(host, key)
                check_refusals(page, host)
                assert page.claim() == 200
                assert other.claim() == 409, "one operator at a time"
                flown = check_flight(page, other)
            except AssertionError:
                print(pathlib.Path(f"{folder}/up.err").read_text(encoding="utf-8")[-3000:])
                raise
            finally:
                for process in (up, view):
                    process.send_signal(signal.SIGINT)
                for process in (up, view):
                    process.wait(timeout=90)
    print(f"ok: {flown} of 3 vehicles flew")


if __name__ == "__main__":
    main()
