"""The Debian packages: built, checked by lintian, and unpacked where the program runs without its sources."""
import json
import pathlib
import re
import shlex
import tempfile

from app import BINARY, DONE, SOURCE, AppTest, main, read_recording, said

BUILD = BINARY.parent


class Packages(AppTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        folder = pathlib.Path(cls.made.name)
        said("/usr/bin/python3", "-B", SOURCE / "packaging/write_papers.py", BUILD)
        said("cpack", "--config", BUILD / "CPackConfig.cmake", "-B", folder)
        cls.packages = sorted(folder.glob("*.deb"))
        cls.root = folder / "root"
        for package in cls.packages:
            said("dpkg-deb", "-x", package, cls.root)
        cls.program = cls.root / "usr/bin/wholehand"

    def test_four_packages_are_built_and_lintian_finds_nothing(self):
        self.assertEqual([p.name.partition("_")[0] for p in self.packages],
                         ["libwholehand-dev", "python3-wholehand", "wholehand-clinic", "wholehand"])
        found = said("lintian", "--no-cfg", "--fail-on", "error,warning", *self.packages)
        self.assertNotRegex(found, "(?m)^[EW]:")

    def test_the_program_runs_without_its_sources(self):
        result = self.run_app("run", "--motion", self.root / "usr/share/wholehand/data/human-motion/reach-grasp-00.csv",
                              "--simulated-clock", "--duration", "1", "--record", "run.h5", "--report", "page",
                              binary=self.program)
        self.expect(result, DONE)
        self.assertNotIn(str(SOURCE), result.out + result.err)
        recorded = read_recording(self.folder / "run.h5")
        self.assertGreater(len(recorded["ticks/q_s"]), 900)  # a second at 1 kHz
        self.assertGreater((self.folder / "page/index.html").stat().st_size, 1_000_000)

    def test_python_steps_a_rig_with_the_packages_files(self):
        package = self.root / "usr/lib/python3/dist-packages"
        for name in ("rig.py", "environment.py", "_rig.pyi", "py.typed"):
            self.assertTrue((package / "wholehand" / name).is_file(), name)
        said_by_it = said("/usr/bin/python3", "-B", "-c", "from wholehand.rig import Rig, shipped; print(Rig().step(n=50), "
                          "shipped('config/scenes/empty.toml'))", cwd=self.folder, env={"PYTHONPATH": str(package)})
        self.assertEqual(said_by_it.split(), ["50", str(self.root / "usr/share/wholehand/config/scenes/empty.toml")])
        needs = said("dpkg-deb", "-f", *(p for p in self.packages if p.name.startswith("python3")), "Depends")
        self.assertRegex(needs, r"python3 \(<< 3\.\d+\).*libbullet")

    def test_every_link_of_the_installed_pages_has_a_target(self):
        pages = sorted((self.root / "usr/share/doc/wholehand").rglob("*.md"))
        self.assertGreater(len(pages), 40)
        links = 0
        for page in pages:
            for target in re.findall(r"\]\(([^)\s#]+)", page.read_text()):
                if ":" not in target:
                    links += 1
                    self.assertTrue((page.parent / target).exists(), f"{page.relative_to(self.root)}: {target}")
        self.assertGreater(links, 300, "links are kept where they lead somewhere")

    def test_examples_clients_and_driver_template_are_installed(self):
        manuals = self.root / "usr/share/doc/wholehand"
        for file in ("examples/01_first_touch.cpp", "examples/CMakeLists.txt", "examples/driver/rails.c",
                     "clients/csharp/Wholehand/WholehandClient.cs", "clients/csharp/README.md",
                     "clients/unity/org.wholehand.client/package.json", "clients/godot/addons/wholehand/plugin.gd",
                     "clients/python/README.md", "clients/python/examples/drop_a_ball.py"):
            self.assertTrue((manuals / file).is_file(), file)
        # The commands of docs/drivers.md, "With the package", run in the folder where the packages are unpacked.
        commands = (SOURCE / "docs/drivers.md").read_text().split("With the package")[1].split("```")[1].splitlines()[1:]
        compile_it, copy_it, run_it = (shlex.split(re.sub(r"(?<= )/usr/", f"{self.root}/usr/", line)) for line in commands)
        for command in ([*compile_it, f"-I{self.root}/usr/include"], copy_it):
            said(*command, cwd=self.folder)
        run_it.remove("--without-passport")
        self.expect_refused(self.run_app(*run_it[1:], binary=self.program), "device rails-0001 has no passport")

    def test_the_drivers_and_the_reader_of_meshes_are_found(self):
        self.expect(self.run_app("device", "list", binary=self.program), DONE, "moteus", "force_dimension", "frame")

    def test_every_subcommand_has_a_man_page_that_names_its_options(self):
        pages = self.root / "usr/share/man/man1"
        self.assertTrue((pages / "wholehand-device-commission.1.gz").is_file())
        page = said("zcat", pages / "wholehand-run.1.gz")
        options = self.run_app("run", "--help", binary=self.program).out
        for option in ("record", "simulated\\-clock", "exercise"):
            self.assertIn("\\-\\-" + option, page)
            self.assertIn("--" + option.replace("\\", ""), options)

    def test_completion_offers_subcommands_and_options(self):
        script = self.root / "usr/share/bash-completion/completions/wholehand"

        def offered(*words):
            line = " ".join(f"'{word}'" for word in words)
            return said("bash", "-c", f"source '{script}'; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; "
                        "_wholehand; printf '%s\\n' \"${COMPREPLY[@]}\"").split()

        self.assertEqual(offered(self.program, "dev"), ["device-host", "device"])
        self.assertEqual(offered(self.program, "device", "comm"), ["commission"])
        self.assertEqual(offered(self.program, "run", "--simul"), ["--simulated-clock"])

    def test_bill_of_materials_lists_linked_libraries_and_page_packages(self):
        bill = json.loads((self.root / "usr/share/doc/wholehand/sbom.spdx.json").read_text())
        self.assertEqual(bill["spdxVersion"], "SPDX-2.3")
        versions = {p["name"]: p["versionInfo"] for p in bill["packages"]}
        self.assertEqual(versions["libbullet-dev"], said("dpkg-query", "-W", "-f=${Version}", "libbullet-dev"))
        lock = json.loads((SOURCE / "web/package-lock.json").read_text())["packages"]
        self.assertEqual(versions["three"], lock["node_modules/three"]["version"])
        self.assertNotIn("vitest", versions)
        named = {p["SPDXID"] for p in bill["packages"]} | {bill["SPDXID"]}
        for relation in bill["relationships"]:
            self.assertLessEqual({relation["spdxElementId"], relation["relatedSpdxElement"]}, named)

    def test_service_is_valid_and_hardened(self):
        unit = self.root / "usr/lib/systemd/system/wholehand.service"
        judged = said("systemd-analyze", "security", "--offline=true", "--threshold=30", unit)
        self.assertIn("OK", judged.splitlines()[-1])


if __name__ == "__main__":
    main()
