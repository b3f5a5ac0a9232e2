"""Common parts of the end-to-end tests with a driver: a device file, its passport, a waiting run, and arming."""
import datetime
import hashlib
import os
import pathlib
import re

import client
from app import BINARY, CONFIG, PacedTest

DRIVERS = pathlib.Path(os.environ.get("WHOLEHAND_DRIVERS", BINARY.parent / "drivers")).resolve()
HARDWARE = ("run", "--exercise", "free-grasping", "--patient", CONFIG / "patients/no-arm.toml", "--port", 0)


def sealed(text):
    """Adds the seal with which commissioning ends its files (docs/commissioning.md)."""
    return f'{text}[seal]\nsha256 = "{hashlib.sha256(text.encode()).hexdigest()}"\n'


def passport_of(device, serial="S-1", day=None, damping=(1.0, 1.2), mass=(0.98, 1.02), known="", delay="[0.0009, 0.0011]"):
    """A passport for a device file with translations; damping and mass as shares of the stated values.

    known: more lines about the driver; delay: delay_s of every axis, and the lines after it.
    """
    text = device.read_text()
    now = datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")
    out = (f'kind = "passport"\nversion = 1\nmeasured_at = "{day + "T00:00:00+00:00" if day else now}"\n'
           f'operator = "A"\ndevice = "{re.search("(?m)^name = .(.*?).$", text)[1]}"\n'
           f'device_sha256 = "{hashlib.sha256(device.read_bytes()).hexdigest()}"\nrate_hz = 1000\nresponds_up_to = 1\nserial = "{serial}"\n{known}')
    for block in text.split("[[axes]]")[1:]:
        value = lambda key: float(re.search(rf"(?m)^{key} = (\S+)", block)[1])
        pair = lambda shares, number: f"[{shares[0] * number:.9g}, {shares[1] * number:.9g}]"
        out += (f'\n[[axes]]\nname = "{re.search("name = .(.*?).$", block, re.M)[1]}"\ntype = "translation"\n'
                f'mass_kg = {pair(mass, value("mass_kg"))}\ndamping_n_s_m = {pair(damping, value("damping_n_s_m"))}\n'
                f'coulomb_n = {pair((0.99, 1.01), value("coulomb_n"))}\ngravity_n = [-0.01, 0.01]\ndelay_s = {delay}\n'
                f'resolution_m = {value("encoder_step_m")}\nmark_m = 0.0\n')
    return sealed(out + "\n")


def rails_commissioned(device, delay):
    """Passport and today's check of the example driver, beside the device file."""
    driver = hashlib.sha256((DRIVERS / "rails.so").read_bytes()).hexdigest().encode()
    known = f'firmware = "1.0"\nsdk = "none"\ndriver_sha256 = "{hashlib.sha256(driver).hexdigest()}"\n'
    passport = passport_of(device, "rails-0001", known=known, delay=delay)
    device.with_suffix(".rails-0001.passport.toml").write_text(passport)
    now = datetime.datetime.now().astimezone().isoformat(timespec="seconds")
    device.with_suffix(".rails-0001.check.toml").write_text(sealed(
        f'kind = "device-check"\nversion = 1\ndone_at = "{now}"\noperator = "A"\n'
        f'passport_sha256 = "{passport.split(chr(34))[-2]}"\n\n'))


class DeviceTest(PacedTest):
    def config_file(self, kind, name, axes=None, **changed):
        """A shipped file with these axes only; its limits tolerate stalls of this machine."""
        head, *blocks = (CONFIG / kind / f"{name}.toml").read_text().split("[[axes]]")
        if axes:
            blocks = [b for b in blocks if re.search('name = "(.*)"', b)[1] in axes]
        text = "[[axes]]".join([head, *blocks])
        for key, value in {"late_in_a_row": "0", "longest_gap_s": "1.0", "stuck_encoder_s": "0.0", **changed}.items():
            text = re.sub(rf"^{key} = \S+", f"{key} = {value}", text, flags=re.M)
        return self.write(f"{kind}-{len(changed)}.toml", text)

    def desktop(self, **changed):
        """Options of the desktop device and its rendering."""
        return ("--device", self.config_file("devices", "desktop-3axis", **changed),
                "--rendering", CONFIG / "rendering/desktop-3axis.toml")

    def start_run(self, *more):
        """Sets `driver_line`, the driver's line in the first output, and `page`, which holds the controls."""
        run = self.start_app(*HARDWARE, "--without-passport", *more)
        first = run.stdout.readline()
        if "http" not in first:
            self.fail(first + run.communicate()[1])
        self.driver_line = line = ""
        while "NOBODY MAY BE ATTACHED" not in line and run.poll() is None:  # the last line before the program waits
            line = run.stdout.readline()
            self.driver_line = line if "driver" in line else self.driver_line
        self.page = client.Page(int(first.split(":")[2].rstrip("/\n")))
        self.page.hold_controls()
        return run

    def wait_for_ticks(self, run, count):
        """Waits for so many ticks of the rendering session, as reported to the page."""
        self.wait_until(run, lambda: self.page.state is not None and self.page.state.number(1, "Q") >= count)

    def arm(self, endings_seen=1):
        accepted, reason = self.page.arm(endings_seen)
        self.assertTrue(accepted, reason)
