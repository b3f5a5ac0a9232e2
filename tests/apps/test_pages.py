"""`wholehand run` with pages: the ports that it opens, Ctrl-C, and refused options."""
import json
import os
import pathlib
import re
import signal
import socket
import time
import urllib.error
import urllib.request

from app import CONFIG, DONE, HANG_S, INTERRUPTED, AppTest, main, read_recording


def inet_sockets(pid):
    """Network sockets of a process: (protocol, local address, port, state), hexadecimal."""
    inodes = set()
    for descriptor in pathlib.Path(f"/proc/{pid}/fd").iterdir():
        try:
            target = os.readlink(descriptor)
        except FileNotFoundError:  # the socket was closed meanwhile
            continue
        if target.startswith("socket:["):
            inodes.add(target[len("socket:["):-1])
    found = []
    for protocol in ("tcp", "tcp6", "udp", "udp6", "raw", "raw6"):
        table = pathlib.Path(f"/proc/{pid}/net/{protocol}")
        if not table.exists():
            continue
        for line in table.read_text().splitlines()[1:]:
            fields = line.split()
            if fields[9] in inodes:
                address, port = fields[1].split(":")
                found.append((protocol, address, int(port, 16), fields[3]))
    return found


LISTENS = "0A"
THIS_MACHINE = "0100007F"  # 127.0.0.1 as /proc/net writes it on a little-endian machine


class Pages(AppTest):
    def start_waiting(self, *arguments):
        """Starts the program with its pages, waiting to be armed; returns it and the address that it prints first."""
        run = self.start_app("run", "--wait", "--port", 0, *arguments)
        url = run.stdout.readline().strip()
        self.assertRegex(url, r"^http://127\.0\.0\.1:\d+/$")
        return run, url

    def health(self, url):
        with urllib.request.urlopen(url + "healthz", timeout=HANG_S) as answer:
            self.assertEqual(answer.status, 200)
            return json.load(answer)

    def end(self, run, code):
        # Before the program catches Ctrl-C nothing is rendered, and the signal's default would end it as well.
        self.wait_until_it_catches(run, signal.SIGINT)
        run.send_signal(signal.SIGINT)
        said, complained = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, code, said + complained)
        self.assertEqual(complained, "")

    def test_address_comes_first_and_answers_for_this_machine_only(self):
        run, url = self.start_waiting("--duration", 600)
        health = self.health(url)
        self.assertIs(health["healthy"], True)
        self.assertEqual(health["run_state"], "disarmed")  # --wait: not armed yet
        self.assertEqual(health["ticks"], 0)
        port = int(url.split(":")[2].rstrip("/"))
        self.assertIn(("tcp", THIS_MACHINE, port, LISTENS), inet_sockets(run.pid))
        listening = [s for s in inet_sockets(run.pid) if s[3] == LISTENS or not s[0].startswith("tcp")]
        self.assertEqual(len(listening), 1, listening)  # and no UDP socket
        self.end(run, INTERRUPTED)  # before the 600 s were over

    def test_ctrl_c_ends_an_endless_run(self):
        run, _ = self.start_waiting()
        self.end(run, INTERRUPTED)
        self.assertEqual(self.names_in(self.folder), [])  # nothing was armed, so nothing was written

    def test_waiting_ends_by_itself(self):
        began = time.monotonic()
        run, _ = self.start_waiting("--duration", 1)
        said, complained = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, DONE, said + complained)
        self.assertGreater(time.monotonic() - began, 1.0)

    def test_ctrl_c_while_it_renders_ramps_and_closes_the_recording(self):
        run = self.start_app("run", "--port", 0, "--duration", 600, "--record", "run.h5")
        url = run.stdout.readline().strip()
        until = time.monotonic() + HANG_S
        while self.health(url)["ticks"] < 1000 and time.monotonic() < until:
            time.sleep(0.1)
        self.assertEqual(self.health(url)["run_state"], "rendering")
        self.end(run, INTERRUPTED)
        with read_recording(self.folder / "run.h5") as recording:
            self.assertGreater(len(recording["ticks/tick"]), 500)
            self.assertEqual(recording["ticks/authority"][-1], 0.0)
            self.assertFalse(recording["ticks/sent"][-1].any())
        self.expect_same_when_run_again("run.h5")

    def test_busy_port_is_reported(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            result = self.run_app("run", "--port", port, "--duration", 3, "--record", "kept/run.h5",
                                  "--json", "kept/run.json")
            self.expect_refused(result, "port", f"127.0.0.1:{port}", "in use", lines=1)
            self.assertEqual(result.out, "")
        self.assertEqual(self.names_in(self.folder), [])  # no folder is left

    def test_summary_of_a_run_with_pages_has_the_same_content(self):
        result = self.run_app("run", "--port", 0, "--duration", 1, "--record", "run.h5", "--json", "run.json")
        self.expect(result, DONE, "cocktail-bar, level 1 of 4", "Done after 1", "run.h5")
        summary = json.loads((self.folder / "run.json").read_text())
        self.assertEqual((summary["faults"], summary["interrupted"]), (0, False))
        with read_recording(self.folder / "run.h5") as recording:
            self.assertEqual(recording["ticks/tick"][-1] + 1, summary["ticks"])  # skipped ticks are counted
        self.expect_same_when_run_again("run.h5")

    def expect_no_socket(self, *arguments):
        run = self.start_app("run", *arguments, "--json", "run.json")
        looked = 0
        until = time.monotonic() + HANG_S
        while run.poll() is None and time.monotonic() < until:
            try:
                found = inet_sockets(run.pid)
            except (FileNotFoundError, ProcessLookupError):  # the process has ended
                break
            self.assertEqual(found, [])
            looked += 1
            time.sleep(0.01)
        said, complained = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, DONE, said + complained)
        self.assertGreater(json.loads((self.folder / "run.json").read_text())["ticks"], 900)
        self.assertGreater(looked, 5)
        self.assertNotIn("http", said)

    def test_no_web_opens_no_port(self):
        self.expect_no_socket("--no-web", "--duration", 1)

    def test_simulated_clock_opens_no_port(self):
        self.expect_no_socket("--simulated-clock", "--duration", 10)


class Refused(AppTest):
    def test_refused_options_are_named(self):
        scene = CONFIG / "scenes/table.toml"
        for arguments, texts in (
                (["--level", 99], ["level", "99", "levels 1 to 4"]),
                (["--level", 0], ["--level", "0"]),
                (["--level", "two"], ["--level", "two"]),
                (["--exercise", "nosuch"], ["nosuch"]),
                (["--exercise", "none/nosuch.toml"], ["none/nosuch.toml"]),
                (["--exercise", scene], ["table.toml", "kind"]),  # a file of another kind
                (["--exercise", "cocktail-bar", "--scene", scene], ["--exercise", "--scene"]),
                (["--exercise", "cocktail-bar", "--motion", "m.csv"], ["--exercise", "--motion"]),
                (["--level", 2, "--scene", scene], ["--level"]),
        ):
            for how in (["--simulated-clock"], ["--port", 0, "--wait"], ["--no-web"]):
                with self.subTest(arguments=arguments, how=how):
                    result = self.run_app("run", *arguments, *how, "--duration", 1)
                    self.expect_refused(result, *texts)
                    self.assertLessEqual(len(result.err.splitlines()), 2, result)
        self.assertEqual(self.names_in(self.folder), [])

    def test_options_of_ports_are_refused_by_a_run_without_ports(self):
        for option in (["--port", 0], ["--wait"], ["--udp", 0], ["--address", "127.0.0.1"],
                     ["--token", "0123456789abcdef"]):
            for how in ("--simulated-clock", "--no-web"):
                with self.subTest(option=option, how=how):
                    self.expect_refused(self.run_app("run", *option, how, "--duration", 1),
                                        option[0], how, lines=1)
        self.assertEqual(self.names_in(self.folder), [])

    def test_other_addresses_need_a_token(self):
        for address in ("0.0.0.0", "::", "192.0.2.1"):
            for token in ([], ["--token", ""], ["--token", "short"]):
                with self.subTest(address=address, token=token):
                    result = self.run_app("run", "--wait", "--port", 0, "--address", address, *token,
                                          "--duration", 3, timeout=HANG_S)
                    self.expect_refused(result, address, "token", "16 characters", lines=1)
                    self.assertEqual(result.out, "")  # no address was printed, so it did not listen

    def test_tokens_are_not_visible_in_the_process_list(self):
        token, lists = "0123456789abcdef", {}
        (self.folder / "tokens").write_text(f"therapist={token}\nplayer={token}-player\n")
        ways = {"--token-file": (["--token-file", "tokens"], None), "--token": (["--token", token], None),
                "--token=": ([f"--token=therapist={token}"], None), "environment": ([], token)}
        for way, (arguments, environment) in ways.items():
            with self.subTest(way=way):
                more = {} if environment is None else {"WHOLEHAND_TOKEN": environment}
                run = self.start_app("run", "--wait", "--port", 0, *arguments, env={**os.environ, **more})
                port = int(re.search(r":(\d+)/", run.stdout.readline()).group(1))
                self.assertNotIn(token.encode(), pathlib.Path(f"/proc/{run.pid}/cmdline").read_bytes())
                self.assertIn(b"--port", pathlib.Path(f"/proc/{run.pid}/cmdline").read_bytes())
                for shown, status in ((token, 200), (token + "x", 401)):
                    self.assertEqual(self.status_of(port, shown), status, shown)
                run.kill()

    def status_of(self, port, token):
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/recordings?token={token}", timeout=HANG_S) as answer:
                return answer.status
        except urllib.error.HTTPError as error:
            return error.code

    def test_files_that_hold_no_tokens_are_named(self):
        os.mkfifo(self.folder / "pipe")
        (self.folder / "empty").write_text("\n")
        (self.folder / "large").write_text("x" * 5000)
        for name, text in (("missing", "no regular file"), ("pipe", "no regular file"), (".", "no regular file"),
                           ("empty", "holds no token"), ("large", "is no list of tokens")):
            with self.subTest(name=name):
                self.expect_refused(self.run_app("run", "--wait", "--port", 0, "--token-file", name), name, text)

    def test_tokens_of_roles_are_refused_by_name(self):
        long = "0123456789abcdef"
        for tokens, texts in (
                ([f"admin={long}"], ["--token", "admin", "therapist="]),
                ([f"player={long}"], ["player token", "therapist="]),
                (["player="], ["--token", "player=", "16 characters"]),
                ([long, f"therapist={long}x"], ["--token", "therapist", "twice"]),
                ([long, f"player={long}"], ["player token", "its own"]),
                ([long, "watcher=short"], ["watcher token", "16 characters"]),
        ):
            with self.subTest(tokens=tokens):
                arguments = [part for token in tokens for part in ("--token", token)]
                result = self.run_app("run", "--wait", "--port", 0, *arguments, "--duration", 1)
                self.expect_refused(result, *texts, lines=1)
                self.assertEqual(result.out, "")

    def test_open_to_others_prints_addresses_of_this_machine(self):
        run = self.start_app("run", "--wait", "--port", 0, "--address", "0.0.0.0", "--token", "0123456789abcdef")
        said = "".join(run.stdout.readline() for _ in range(4))
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=HANG_S)
        self.assertRegex(said, r"^http://127\.0\.0\.1:(\d+)/\n"
                               r"  game     http://127\.0\.0\.1:\1/\?token=<token>\n"
                               r"  console  http://127\.0\.0\.1:\1/console\?token=<token>\n"
                               r"  others   http://<this machine>:\1/\?token=<token>\n$")

    def test_invalid_port_is_refused(self):
        for port in ("65536", "-1", "http"):
            with self.subTest(port):
                self.expect_refused(self.run_app("run", "--port", port, "--duration", 1), "--port",
                                    port)


if __name__ == "__main__":
    main()
