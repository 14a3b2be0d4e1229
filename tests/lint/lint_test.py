#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Findings of the lint checks, and cases that pass, in small trees made for each test."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import commits  # noqa: E402
import configurations  # noqa: E402
import includes  # noqa: E402
import links  # noqa: E402
import message_keys  # noqa: E402
import spdx  # noqa: E402
import tools  # noqa: E402
from tree import Tree  # noqa: E402

IDENTITY = ("-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "core.hooksPath=/dev/null")


class LintTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="sonard_lint_")
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.git("init", "-q")

    def git(self, *arguments):
        subprocess.run(["git", *IDENTITY, *arguments], cwd=self.root, check=True, capture_output=True)

    def write(self, texts):
        """The tree with these files added, {path: text}."""
        for name, text in texts.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return Tree(self.root)


class Cycles(LintTest):
    CIRCLE = {"server/a/one.hpp": '#include "server/b/two.hpp"\n',
              "server/b/two.hpp": '#include <vector>\n#include "server/c/three.hpp"\n',
              "server/c/three.hpp": '#include "server/a/one.hpp"\n'}

    def complaints(self, tree):
        return list(includes.cycle_complaints(includes.arrows(tree)))

    def test_a_circle_of_three_is_shown_with_its_includes(self):
        complaints = self.complaints(self.write(self.CIRCLE))
        self.assertEqual(len(complaints), 1)
        for text in ("server/a -> server/b", "server/b -> server/c", "server/c -> server/a",
                     "server/b/two.hpp:2 includes server/c/three.hpp"):
            self.assertIn(text, complaints[0])

    def test_no_circle_no_complaint(self):
        tree = self.write({**self.CIRCLE, "server/c/three.hpp": '#include "server/c/other.hpp"\n'})
        self.assertEqual(self.complaints(tree), [])

    def test_headers_beside_the_file_are_of_its_folder(self):
        tree = self.write({"server/a/one.hpp": '#include "two.hpp"\n', "server/a/two.hpp": '#include "../b/three.hpp"\n',
                          "server/b/three.hpp": '#include "../a/one.hpp"\n'})
        self.assertEqual(set(includes.arrows(tree)), {("server/a", "server/b"), ("server/b", "server/a")})

    def test_generated_headers_belong_to_the_folder_of_their_path(self):
        tree = self.write({"server/a/one.cpp": '#include "protocol/pose/pose.pb.h"\n'})
        self.assertEqual(set(includes.arrows(tree)), {("server/a", "protocol/pose")})


class Libraries(LintTest):
    def complaints(self, lists, *sources):
        return list(includes.library_complaints(self.write({"server/a/CMakeLists.txt": lists,
                                                            **{f"server/{name}": "" for name in sources}})))

    def test_one_library_with_all_sources(self):
        self.assertEqual(self.complaints("sonard_library(sonard_a one.cpp\n  two.cpp)\n", "a/one.cpp", "a/two.cpp"), [])

    def test_a_program_beside_it(self):
        self.assertEqual(self.complaints("sonard_library(sonard_a one.cpp)\nsonard_program(a main.cpp)\n",
                                         "a/one.cpp", "a/main.cpp"), [])

    def test_two_libraries(self):
        complaints = self.complaints("sonard_library(x one.cpp)\nsonard_library(y two.cpp)\n", "a/one.cpp", "a/two.cpp")
        self.assertEqual(complaints, ["server/a/CMakeLists.txt: 2 libraries, x and y; a folder is one"])

    def test_a_source_of_nobody_and_one_of_another_folder(self):
        complaints = self.complaints("sonard_library(x ../b/two.cpp)\n", "a/one.cpp")
        self.assertEqual([complaint.split(": ")[1] for complaint in complaints],
                         ["one.cpp is in no library and no program", "../b/two.cpp lies in another folder"])

    def test_a_source_for_each_device(self):
        sources = [f"a/{device}_fields.cpp" for device in includes.DEVICES]
        lists = "sonard_library(x one.cpp)\ntarget_sources(x PRIVATE ${device}_fields.cpp)\n"
        self.assertEqual(self.complaints(lists, "a/one.cpp", *sources), [])
        self.assertEqual(self.complaints(lists, "a/one.cpp", "a/toaster_fields.cpp"),
                         ["server/a/CMakeLists.txt: toaster_fields.cpp is in no library and no program"])

    def test_sources_without_a_list(self):
        self.assertEqual(self.complaints("", "b/one.cpp"), ["server/b: has sources and no CMakeLists.txt"])


class Layers(LintTest):
    def refused(self, includes_of):
        """The pairs (path, include) that are refused."""
        found = []
        for path, include in includes_of:
            tree = self.write({path: f"#include {include}\n"})
            found += [(path, include)] * len(list(includes.layer_complaints(tree)))
            (self.root / path).unlink()
        return found

    def test_arrows_up_are_refused(self):
        up = [("protocol/gemini/a.cpp", '"server/clock.hpp"'),
              ("protocol/pose/a.cpp", '"renderer/pose.hpp"'),
              ("protocol/gemini/a.cpp", '"protocol/micron/frame.hpp"'),
              ("renderer/a.hpp", '"protocol/common/result.hpp"'),
              ("renderer/a.hpp", '"common/command_line/help_formatter.hpp"'),
              ("common/text/a.hpp", '"protocol/common/result.hpp"'),
              ("renderer/picture/a.hpp", '"renderer/pose.hpp"'),
              ("clients/x/a.hpp", '"server/clock.hpp"'),
              ("clients/x/a.hpp", '"renderer/pose.hpp"'),
              ("server/a.hpp", '"clients/x/a.hpp"'),
              ("protocol/gemini/a.cpp", "<boost/asio.hpp>"),
              ("renderer/a.cpp", "<yaml-cpp/yaml.h>"),
              ("server/a.cpp", "<osg/Node>")]
        self.assertEqual(self.refused(up), up)

    def test_arrows_down_pass(self):
        self.assertEqual(self.refused([("protocol/gemini/a.cpp", '"protocol/common/result.hpp"'),
                                       ("server/a/a.cpp", '"renderer/pose.hpp"'),
                                       ("renderer/a.cpp", '"common/text/printable.hpp"'),
                                       ("clients/x/b.cpp", '"common/text/printable.hpp"'),
                                       ("server/b/a.cpp", '"protocol/micron/frame.hpp"'),
                                       ("clients/x/a.cpp", '"renderer/picture/fan_image.hpp"'),
                                       ("renderer/a.cpp", "<osg/Node>"),
                                       ("server/c/a.cpp", "<boost/asio.hpp>"),
                                       ("tests/a.cpp", '"server/clock.hpp"')]), [])


class Spdx(LintTest):
    def test_each_kind_of_source_gets_it_after_its_first_line_if_that_names_an_interpreter(self):
        tree = self.write({"a.cpp": "int a;\n", "b.py": "#!/usr/bin/python3\npass\n", "c/CMakeLists.txt": "",
                          "run": "#!/bin/bash\ntrue\n", "notes.md": "# Notes\n"})
        self.assertEqual(len(list(spdx.spdx_complaints(tree))), 4)
        self.assertEqual(list(spdx.add_lines(tree)), ["a.cpp", "b.py", "c/CMakeLists.txt", "run"])
        self.assertEqual((self.root / "a.cpp").read_text(), "// SPDX-License-Identifier: Apache-2.0\nint a;\n")
        self.assertEqual((self.root / "run").read_text(), "#!/bin/bash\n# SPDX-License-Identifier: Apache-2.0\ntrue\n")
        self.assertEqual(list(spdx.spdx_complaints(Tree(self.root))), [])


class Links(LintTest):
    README = "# A\n[one](docs/one.md#how-it-goes) [picture](docs) `[no](link)`\n```\n[no](link)\n```\n"

    def complaints(self, texts):
        return list(links.link_complaints(self.write({"README.md": self.README, **texts})))

    def test_what_is_there_passes(self):
        self.assertEqual(self.complaints({"docs/one.md": "[two](two.md) [out](https://nowhere.example)\n## How it `goes`\n",
                                          "docs/two.md": "[up](../README.md#a) [self](#b-1)\n# B\n# B\n"}), [])

    def test_what_is_not_there_is_named_with_its_place(self):
        said = self.complaints({"docs/one.md": "\n[two](two.md)\n", "docs/three.md": "[a](#b)\n"})
        self.assertEqual(said, ["README.md:2: docs/one.md#how-it-goes: docs/one.md has no heading of that name",
                                "docs/one.md:2: two.md: there is no docs/two.md",
                                "docs/three.md:1: #b: docs/three.md has no heading of that name",
                                "docs/three.md: no way of links leads to it from README.md"])


class Configurations(LintTest):
    SCHEMA = '{"type": "object", "additionalProperties": false, "properties": {"gpu": {"enum": ["on", "off"]}}}'

    def complaints(self, text):
        return list(configurations.configuration_complaints(
            self.write({"configs/a.yaml": text, "configs/schema/sonard.schema.json": self.SCHEMA})))

    def test_on_is_a_word_as_it_is_to_the_daemon(self):
        self.assertEqual(self.complaints("gpu: on\n"), [])

    def test_unknown_keys_and_values_are_found_with_their_place(self):
        self.assertIn("configs/a.yaml: $.gpu", self.complaints("gpu: true\n")[0])
        self.assertIn("gqu", self.complaints("gqu: on\n")[0])


class MessageKeys(LintTest):
    HEAD = ('{"properties": {"hides_vehicle": {"type": "boolean"}, "acoustics": {"properties": {"multipath": {"properties": '
            '{"level": {"enum": ["full", "off"]}}}}}}}')
    SCHEMA = ('{"properties": {"gpu": {"properties": {"device": {"type": "string"}, "retry_s": {"type": "number"}}}, '
              '"heads": {"items": {"oneOf": [' + HEAD + ']}}}}')

    def complaints(self, source):
        return list(message_keys.key_complaints(
            self.write({"server/a.cpp": source, message_keys.SCHEMA: self.SCHEMA})))

    def test_keys_that_are_accepted_pass(self):
        for message in ("try acoustics.multipath.level: off, or a GPU", "heads[{}].acoustics.multipath.level", "multipath.level",
                        "gpu.device: the number of a device", "gpu.retry_s: 2.5", "hides_vehicle: true leaves it out"):
            self.assertEqual(self.complaints(f'say("{message}");'), [], message)

    def test_an_unknown_key_is_named_with_its_file(self):
        for message, key in (("try acoustics.multipaths.level: off", "acoustics.multipaths.level"),
                             ("heads[0].multipath.level", "heads.multipath.level"), ("gpus.device", "gpus.device"),
                             ("gpu.devices", "gpu.devices"), ("(acoustics.level)", "acoustics.level")):
            self.assertEqual(self.complaints(f'say("{message}");'),
                             [f"server/a.cpp: a message names the key '{key}', which no configuration has"])

    def test_a_value_that_the_key_does_not_take_is_named(self):
        for message in ("acoustics.multipath: off", "multipath.level: on", "gpu.retry_s: off", "hides_vehicle: yes"):
            self.assertEqual(self.complaints(f'say("{message}");'),
                             [f"server/a.cpp: a message names '{message}', which no configuration takes"])

    def test_literals_are_joined_and_other_text_is_left_alone(self):
        self.assertEqual(len(self.complaints('say("try acoustics."\n      "multipaths: off");')), 1)
        self.assertEqual(self.complaints('// gpu.devices\n#include "gpu.devices"\nsay("gpu.md, other.words, a.device::b");'), [])


class Commits(LintTest):
    def test_subjects(self):
        for subject in ("docs: say so", "protocol/micron: test it", "server, renderer/scene: move it", "build: " + 65 * "x"):
            self.assertIsNone(commits.subject_complaint(subject), subject)
        for subject in ("Say so", "docs:say so", "docs: ", "build: " + 66 * "x", "Docs: say so"):
            self.assertIsNotNone(commits.subject_complaint(subject), subject)

    def test_counted_from_a_base_from_the_last_tag_or_from_the_commit_that_brought_the_check(self):
        for number, subject in enumerate(("Old one", "tests: bring it", "Bad one", "docs: good one", "Worse one")):
            path = "tests/lint/commits.py" if number == 1 else f"file{number}"
            self.write({path: str(number)})
            self.git("add", "-A")
            self.git("commit", "-q", "-m", subject)
        tree = Tree(self.root)
        subjects = [line.split("'")[1] for line in commits.commit_complaints(tree, None)]
        self.assertEqual(subjects, ["Worse one", "Bad one"])
        self.assertEqual(len(list(commits.commit_complaints(tree, "HEAD~4"))), 2)
        self.git("tag", "v1", "HEAD~1")
        self.assertEqual(len(list(commits.commit_complaints(tree, None))), 1)


class Tools(LintTest):
    def test_format(self):
        tree = self.write({"good.cpp": "int a;\n", "bad.cpp": "int   a ;\n"})
        self.assertEqual(list(tools.format_complaints(tree, ["good.cpp"])), [])
        self.assertIn("bad.cpp:1", "".join(tools.format_complaints(tree, tree.files)))

    def test_shell(self):
        tree = self.write({"good": "#!/bin/bash\necho\n", "bad": "#!/bin/bash\ncd $1 || exit\n"})
        self.assertIn("In bad line 2", "".join(tools.shell_complaints(tree)))
        (self.root / "bad").unlink()
        self.assertEqual(list(tools.shell_complaints(Tree(self.root))), [])

    def test_spelling(self):
        misspelt = "rec" + "ieve"
        tree = self.write({"none": "", "ignored": misspelt + "\n", "docs/a.md": f"To {misspelt}.\n"})
        self.assertIn("docs/a.md:1", "".join(tools.spelling_complaints(tree, str(self.root / "none"))))
        self.assertEqual(list(tools.spelling_complaints(tree, str(self.root / "ignored"))), [])

    def test_tidy_without_the_precompiled_header_of_another_compiler(self):
        command = f"g++ -Winvalid-pch -include {self.root}/x/cmake_pch.hxx -c {self.root}/bad.cpp"
        tree = self.write({"bad.cpp": "int* a = 0;\n", "good.cpp": "int* a = nullptr;\n",
                          "build/release/compile_commands.json": f'''[
            {{"directory": "{self.root}", "file": "{self.root}/bad.cpp", "command": "{command}"}},
            {{"directory": "{self.root}", "file": "{self.root}/good.cpp", "command": "g++ -c {self.root}/good.cpp"}}]'''})
        (self.root / ".clang-tidy").write_text("Checks: '-*,modernize-use-nullptr'\n", encoding="utf-8")
        self.assertEqual(list(tools.tidy_complaints(tree, ["good.cpp", "not_compiled.hpp"])), [])
        complaints = list(tools.tidy_complaints(tree, ["bad.cpp", "good.cpp"]))
        self.assertEqual(len(complaints), 1)
        self.assertIn("modernize-use-nullptr", complaints[0])

    def test_tidy_of_a_source_that_is_compiled_with_others(self):
        unity = f"{self.root}/Unity/unity_0_cxx.cxx"
        tree = self.write({"bad.cpp": "int* a = 0;\n", "good.cpp": "int* b = nullptr;\n",
                          "Unity/unity_0_cxx.cxx": f'#include "{self.root}/good.cpp"\n\n#include "{self.root}/bad.cpp"\n',
                          "build/release/compile_commands.json": f'''[
            {{"directory": "{self.root}", "file": "{unity}", "command": "g++ -c {unity}"}}]'''})
        (self.root / ".clang-tidy").write_text("Checks: '-*,modernize-use-nullptr'\n", encoding="utf-8")
        complaints = list(tools.tidy_complaints(tree, ["bad.cpp", "good.cpp"]))
        self.assertEqual(len(complaints), 1)
        self.assertIn("modernize-use-nullptr", complaints[0])


class Trees(LintTest):
    def test_what_changed_since_a_base_is_what_this_branch_did(self):
        self.write({"a": "1", "b": "1"})
        self.git("add", "-A")
        self.git("commit", "-q", "-m", "x: first")
        self.git("branch", "base")
        tree = self.write({"b": "2", "c": "1"})
        self.assertEqual(tree.changed_since("base"), ["b", "c"])
        self.assertEqual(tree.changed_since("HEAD"), ["b", "c"])


if __name__ == "__main__":
    unittest.main()
