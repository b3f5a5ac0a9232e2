"""Too few descriptors or no memory for a thread: the program reports it in a sentence, and a running loop continues."""
import json
import resource
import signal
import socket
import urllib.request

import faulty_disk  # noqa: F401  makes the following modules importable
import client
from app import BAD_INPUT, DONE, FREE_RUN, HANG_S, INTERRUPTED, AppTest, PacedTest, main

FAILED = 4


def limit(what, value):
    return lambda: resource.setrlimit(what, (value, resource.getrlimit(what)[1] if what == resource.RLIMIT_STACK else value))


class Limits(AppTest):
    def expect_a_sentence(self, result):
        self.assertIn(result.code, (DONE, BAD_INPUT, FAILED), result)
        self.assertNotIn("terminate", result.out + result.err)
        if result.code != DONE:
            self.assertRegex(result.err, r"^wholehand: \S")

    def test_few_descriptors_suffice_or_are_reported(self):
        for descriptors in (4, 6, 8, 10, 12, 14, 16):
            with self.subTest(descriptors=descriptors):
                self.expect_a_sentence(self.run_app(
                    *FREE_RUN, "--simulated-clock", "--duration", "0.2", "--record", f"{descriptors}.h5",
                    preexec_fn=limit(resource.RLIMIT_NOFILE, descriptors)))

    def test_no_memory_for_a_thread_is_reported_in_a_sentence(self):
        # A thread's stack is as large as this limit, which no machine can provide.
        no_stack = limit(resource.RLIMIT_STACK, 1 << 46)
        for more in (["--simulated-clock"], ["--no-rehearsal"], []):
            with self.subTest(more=more):
                result = self.run_app(*FREE_RUN, "--duration", "0.2", "--record", "run.h5", *more, preexec_fn=no_stack)
                self.expect_a_sentence(result)
        result = self.run_app("run", "--port", 0, "--wait", timeout=HANG_S, preexec_fn=no_stack)
        self.expect(result, FAILED, "a thread could not be started", "ulimit -a")


class Crowded(PacedTest):
    def test_pages_that_use_up_the_descriptors_do_not_prevent_a_stop(self):
        run = self.start_app("run", "--port", 0, "--wait", "--no-rehearsal", preexec_fn=limit(resource.RLIMIT_NOFILE, 32))
        port = int(run.stdout.readline().split(":")[2].rstrip("/\n"))
        page = client.Page(port)
        self.addCleanup(page.socket.close)
        page.hold_controls()
        accepted, reason = page.arm(1)
        self.assertTrue(accepted, reason)
        others = []
        for _ in range(60):
            other = socket.create_connection(("127.0.0.1", port), timeout=HANG_S)
            other.sendall(b"GET /healthz HTTP/1.1\r\n")  # the request never ends
            others.append(other)
        self.assertTrue(page.answer(page.say(client.EMERGENCY_STOP))[0])
        page.wait_for_endings(2)
        for other in others:
            other.close()
        healthy = []

        def new_client_gets_in():
            try:
                with urllib.request.urlopen(f"http://127.0.0.1:{port}/healthz", timeout=HANG_S) as answer:
                    healthy.append(json.load(answer))
            except OSError:
                pass
            return healthy
        self.wait_until(run, new_client_gets_in)
        self.assertTrue(healthy)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, INTERRUPTED, out + err)


if __name__ == "__main__":
    main()
