"""Clients whose HTTP headers are megabytes long, beside an armed session: `python3 test_giant_headers.py` prints the
periods that the loop skipped and the time of a stop, without such clients and with three. The verdict is on how often
they are refused, and on what that costs the program."""
import pathlib
import re
import socket
import threading
import time
import urllib.request

import client
from app import FULL, HANG_S, main
from test_sessions import Running

CLIENTS, SECONDS = 3, 20 if FULL else 4
GIANT = b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + 2_000_000 * b"x" + b"\r\n\r\n"


def processor_s(pid, thread):
    """CPU time of the threads of that name."""
    total_s = 0.0
    for stat in pathlib.Path(f"/proc/{pid}/task").glob("*/stat"):
        text = stat.read_text()
        if text[text.index("(") + 1:text.rindex(")")] == thread:
            user, system = text[text.rindex(")") + 2:].split()[11:13]
            total_s += (int(user) + int(system)) / 100
    return total_s


class Flood:
    """Asks again and again, each client on a new connection as soon as it was refused."""

    def __init__(self, port):
        self.ends = threading.Event()
        self.threads = [threading.Thread(target=self._ask, args=(port,)) for _ in range(CLIENTS)]
        for thread in self.threads:
            thread.start()

    def _ask(self, port):
        while not self.ends.is_set():
            try:
                with socket.create_connection(("127.0.0.1", port), timeout=HANG_S) as line:
                    line.sendall(GIANT)
                    line.recv(1000)
            except ConnectionError:
                pass  # refused before all was sent

    def close(self):
        self.ends.set()
        for thread in self.threads:
            thread.join()


class GiantHeaders(Running):
    def metric(self, name):
        said = urllib.request.urlopen(self.url + "metrics", timeout=HANG_S).read().decode()
        found = re.search(rf"^{re.escape(name)} (\S+)", said, re.M)
        return float(found[1]) if found else 0.0

    def measure(self, run, what):
        names = ("wholehand_ticks_total", "wholehand_missed_deadlines_total",
                 'wholehand_refused_total{reason="header_too_large"}')
        before, cpu_s, began_s = [self.metric(name) for name in names], processor_s(run.pid, "wholehand-web"), time.monotonic()
        time.sleep(SECONDS)
        ticks, missed, refused = (self.metric(name) - was for name, was in zip(names, before))
        took_s, cpu_s = time.monotonic() - began_s, processor_s(run.pid, "wholehand-web") - cpu_s
        stop_s = time.monotonic()
        self.assertTrue(self.page.answer(self.page.say(client.STOP))[0])
        stop_s = time.monotonic() - stop_s
        print(f"figure: {what}: {100 * missed / max(ticks, 1):.2f} % of {ticks:.0f} periods skipped, a stop answered after "
              f"{1000 * stop_s:.0f} ms, {refused / took_s:.1f} refusals/s, web thread {100 * cpu_s / took_s:.0f} %")
        return refused, took_s, cpu_s

    def test_clients_of_giant_headers_cost_the_program_little(self):
        run = self.start("--exercise", "cocktail-bar")
        for what, giant in (("no other clients", False), ("three clients of 2 MB headers", True)):
            accepted, reason = self.page.arm(self.endings)
            self.assertTrue(accepted, reason)
            flood = Flood(int(self.url.split(":")[2].rstrip("/"))) if giant else None
            try:
                refused, took_s, cpu_s = self.measure(run, what)
            finally:
                if flood:
                    flood.close()
            self.endings += 2
            self.page.wait_for_endings(self.endings)
            if giant:
                self.assertGreater(refused, 0)
                self.assertLessEqual(refused, CLIENTS * (took_s / 0.5 + 1))  # src/station/server/http_connection.cpp
        self.end(run)


if __name__ == "__main__":
    main()
