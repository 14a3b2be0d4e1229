#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every command in README.md and docs is run as printed, or is listed here with the reason why it is not run.

    commands_test.py --programs DIR [TestCase.test_name ...]

Each command has a folder like the root of the repository, a machine of its own (a network namespace), and the files from
the surrounding text. A command that runs until it is stopped gets SIGTERM once it has shown that it works. It must then end
cleanly.
"""

import argparse
import concurrent.futures
import dataclasses
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(HERE))

from commands import blocks, commands  # noqa: E402

PROGRAMS = None  # folder of the programs under test
PATIENCE_S = 120
SOME_LOST = 4  # of sonarview, which is then right: a machine that runs several of these at once may be too slow for each ping

# Placeholders in the documents, and their values here.
PLACEHOLDERS = {"--log-format F": "--log-format json", "CONFIG": "configs/demo.yaml", "LOG": "log.mcap", "DIR": "out", "NAME": "demo-micron", "SECONDS": "1",
                "FILE": "configs/trajectories/demo.csv", "ADDRESS": "127.0.0.3", "<device>": "micron", "E": "cpu", "L": "info"}

# Files from the text: name -> (document, index of the block among the blocks of that language).
FILES = {"harbour.sdf": ("docs/worlds.md", "xml", 0), "harbour.yaml": ("docs/worlds.md", "yaml", 0),
         "wreck.sdf": ("docs/worlds.md", "xml", 1), "harbour.csv": ("docs/offline.md", "", 1), "pipeline.sh": ("docs/ci.md", "sh", 2)}
# Files of the reader, and similar files of the repository.
LIKE = {"my.yaml": "configs/gazebo.yaml", "survey.tum": "configs/trajectories/demo.csv",
        "dive.csv": "configs/trajectories/docking_demo.csv"}

TWO_HEADS = """
engine: cpu
sampling: {preset: fast}
world: {file: harbour.sdf}
poses: {initial: {position_m: [0, 0, -3]}}
heads:
  - {name: a, type: gemini_720i, sonar_id: 513,
     network: {bind: 127.0.0.2, alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}}
  - {name: b, type: gemini_720i, sonar_id: 514,
     network: {bind: 127.0.0.3, alternate_address: 127.0.0.3, netmask: 255.0.0.0, status: [127.0.0.1]}}
"""
# A mesh of the reader: a pyramid of 12 x 3 x 4 m in millimetres, with y up.
CORNERS = [(-6000, 0, -2000), (6000, 0, -2000), (6000, 0, 2000), (-6000, 0, 2000), (0, 3000, 0)]
WRECK = "solid wreck\n" + "".join(
    "facet normal 0 0 0\nouter loop\n" + "".join("vertex %d %d %d\n" % CORNERS[k] for k in facet) + "endloop\nendfacet\n"
    for facet in ((0, 1, 2), (0, 2, 3), (0, 4, 1), (1, 4, 2), (2, 4, 3), (3, 4, 0))) + "endsolid wreck\n"
DUMP = """
engine: cpu
world: {file: harbour.sdf}
poses: {initial: {position_m: [0, 0, -3]}}
heads:
  - {name: gemini, type: gemini_720i, sonar_id: 513, dump: {directory: dump},
     network: {bind: 127.0.0.2, alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}}
"""


@dataclasses.dataclass(frozen=True)
class Run:
    """How commands that match are run."""

    pattern: str
    until: str = ""  # what is true, to a shell, when SIGTERM is sent; its lines are in `output`. Empty: it ends by itself
    beside: tuple = ()  # configurations that sonard serves meanwhile
    before: str = ""  # what the text has the reader do before
    addresses: tuple = ()  # of the machine, beside those of loopback
    codes: tuple = (0,)  # exit status


@dataclasses.dataclass(frozen=True)
class NotRun:
    """Commands that match are not run, and why."""

    pattern: str
    why: str


@dataclasses.dataclass(frozen=True)
class Mention:
    """Not a command: a program with one of its options, which has to be in the program's --help."""

    pattern: str


SONARD, VIEW, CAST = r"(build/release/bin/)?sonard ", r"(build/release/bin/)?sonarview ", r"(build/release/bin/)?posecast "
COMPARE = r"PYTHONPATH=clients/python python3 -m sonard_client.compare "
GEMINI, VEHICLE = ("configs/demo.yaml",), ("10.61.19.200", "10.61.19.10")
READY, PROGRESS = 'grep -q "sonard ready" output', 'grep -qE "[1-9][0-9]* (pings|lines)" output'
PICTURE, SCAN = "ls out*/fan-last.png || ls out*/*/fan-last.png", "ls out*/turn-last.png"
FRAME = "ls */ping_000000.json"
POSES_ARRIVE = """python3 -c 'import re, sys, urllib.request
page = urllib.request.urlopen("http://127.0.0.1:8014/metrics").read().decode()
sys.exit(not re.search(r"sonard_poses_total.* [1-9]", page))'"""
MAKE_LOG = ("printf 't,x,y,z,qx,qy,qz,qw\\n0,-2,-12,-25.6,0,0,.64,.77\\n.2,-2,-12,-25.6,0,0,.64,.77\\n' > way.csv && sonard render "
            "configs/demo.yaml --trajectory way.csv --out made --rate 10 --range 5 --picture-every 1 --mcap && cp made/*.mcap log.mcap")
TURNS = r"""python3 -c 'import json
for number in range(400):
    print(json.dumps({"number": number, "turn": number // 200, "unix_s": number / 25, "bearing": number % 200 * 32, "status": 144,
                      "sweep": 0, "control": 9089, "range_scale": 0, "tx_word": 0, "gain": 84, "slope": 0, "ad_span": 81,
                      "ad_low": 8, "heading_offset": 0, "ad_interval": 52, "left_limit": 0, "right_limit": 6399, "step": 32,
                      "all_round": True, "bits": 8, "bins": bytes((k * number) % 251 for k in range(200)).hex()}))' > turn.jsonl"""
TAKE_POSES = """python3 -c 'import socket
server = socket.create_server(("", 14601)); peer = server.accept()[0]
while data := peer.recv(4096): open("taken", "ab").write(data)' &
until grep -q :3909 /proc/net/tcp; do sleep 0.1; done"""  # 14601 in hexadecimal digits

RULES = [
    NotRun(r"\./run|\./test", "installs packages and builds; tests/package and ./test itself do"),
    NotRun(r"(cmake|ctest) .*", "configures, builds or installs"),
    NotRun(r"build/release/bin/(\w+_(test|bench|pictures)|tune_presets)( .*)?", "a test or measurement by itself, of minutes"),
    NotRun(r"tests/bench/.*", "draws the measurements of the command before"),
    NotRun(r"(docker|kubectl|apt) .*|docker/.*|clients/examples/slurm/.*", "needs another host, a cluster or packages; tests/containers and tests/cluster run them"),
    NotRun(r"sudo .*", "needs sudo, and interfaces with these names; tests/system/gemini/link_test.py makes the same network"),
    NotRun(r"for n in 1 2; do\n.*", "needs the host's interface enp3s0"),
    NotRun(r"(\S*roscast|roscore|rostopic|rosdep|ros2|colcon|pip|ln|cd REPOSITORY) .*", "needs ROS; tests/simulators has rosmaster and stand-ins"),
    NotRun(r"sim_vehicle.py .*|set streamrate 50", "needs ArduPilot's simulator; tests/simulators has node-mavlink"),
    NotRun(r"tshark .*", "needs a capture with traffic of all heads; tests/logs runs it"),
    NotRun(r"protoc .*|cp clients/examples/stonefish/.*", "writes into the reader's simulator; tests/simulators builds these examples"),
    NotRun(SONARD + r"selftest --gpu-device NAME", "needs a GPU"),
    NotRun(r"(python3 )?clients/examples/dataset/.*", "504 images take minutes; tests/system/dataset makes fewer"),
    Mention(r"sonard (render|check) --(?!help)\w+|sonarview micron --raw"),
    # sonard
    Run(SONARD + r"--version|" + SONARD + r"render --help|" + VIEW + r"(micron )?--help"),
    Run(SONARD + r"demo( <device>)?", until=PROGRESS),
    Run(SONARD + r"selftest( --json| \[--engine E\] \[--gpu-device D\] \[--json\])?"),
    Run(SONARD + r"check (--json )?CONFIG( \[--no-network\] \[--json\])?"),
    Run(SONARD + r"check --no-network (configs/gemini-netns.yaml|CONFIG)"),
    Run(SONARD + r"check CONFIG --listen (5|SECONDS)", before="posecast configs/trajectories/docking_demo.csv --loop &"),
    Run(SONARD + r"check configs/ardusub.yaml --listen 5", codes=(2,)),  # no vehicle sends
    Run(SONARD + r"check my.yaml"),
    Run(SONARD + r"check my.yaml --listen 5", codes=(2, 3)),  # no Gazebo runs
    Run(SONARD + r"run (CONFIG( \[--log-level L\] \[--log-format F\])?|my.yaml|configs/(NAME|demo(-\w+)?|ardusub|bluerov2|(gemini|oculus)-and-ping360|two-vehicles-[ab]).yaml)", until=READY),
    Run(SONARD + r"run ~/sonar/demo-oculus.yaml", until=READY, before="ln -s $PWD/configs ~/sonar"),
    Run(SONARD + r"run configs/gemini-netns.yaml", until=READY, addresses=VEHICLE),
    Run(SONARD + r"run configs/container.yaml", until=READY, before="ip link add eth0 type veth peer name eth1 && ip link set eth1 up && "
                                                                    "ip address add 10.61.19.201/24 dev eth0 && ip link set eth0 up"),
    Run(SONARD + r"render configs/\w+.yaml .*", until=FRAME, codes=(0, 143)),  # goes on where it was ended
    Run(SONARD + r"render (harbour|clean).yaml .*", until=FRAME, codes=(0, 143)),
    Run(SONARD + r"info LOG( --png out| \[--json\])?", before=MAKE_LOG),
    Run(SONARD + r"replay LOG( \[--config CONFIG\])?", before=MAKE_LOG, until=READY),
    # clients
    Run(VIEW + r"(--range (10|20) (--compression 1 )?)?--out out", until=PICTURE, beside=GEMINI),
    Run(VIEW + r"--range 20 --pings 20 --out out", beside=GEMINI),
    Run(VIEW + r"--(continuous 100|drop-rx 0.05 --drop-tx 0.05) --pings 200.*", until=PROGRESS, beside=GEMINI),
    Run(VIEW + r"--client-address 10.61.19.10 --sonar-id 513", until=PROGRESS, beside=("configs/gemini-netns.yaml",), addresses=VEHICLE,
        before="posecast configs/trajectories/docking_demo.csv --loop &"),
    Run(VIEW + r"--sonar-id 513,514( --out out)?", until=PROGRESS, beside=("two-heads.yaml",)),
    Run(VIEW + r"--bind 127.0.0.[13] .*", until=PICTURE, beside=("configs/two-vehicles-a.yaml", "configs/two-vehicles-b.yaml")),
    Run(VIEW + r"micron --tcp 127.0.0.1:4001 (--range 20 )?--out out(-micron)?", until=SCAN, beside=("configs/demo-micron.yaml",)),
    Run(VIEW + r"(micron|ping360) --tty /dev/ttyUSB0 .*", codes=(3,)),  # no such line on this machine
    Run(VIEW + r"micron --(tcp|udp) 10.0.0.7:4001 .*", codes=(3,)),  # the same
    Run(VIEW + r"oculus (--out out|--head ADDRESS)", until=PROGRESS, beside=("configs/demo-oculus.yaml",)),
    Run(VIEW + r"oculus (--head 127.0.0.3 )?--pings 10 .*", beside=("configs/oculus-and-ping360.yaml",)),
    Run(VIEW + r"oculus --frequency high .*", until=PROGRESS, beside=("configs/demo-oculus.yaml",)),
    Run(VIEW + r"ping360 --udp 127.0.0.1:12345 --out out", until=SCAN, beside=("configs/demo-ping360.yaml",)),
    Run(VIEW + r"ping360 --udp 127.0.0.1:12345 --auto --turns 1.*", beside=("configs/oculus-and-ping360.yaml",)),
    Run(VIEW + r"ping360 --udp 127.0.0.1:9092 --auto --out out-ping360", until=SCAN, beside=("configs/bluerov2.yaml",)),
    Run(VIEW + r"ping1d --udp 127.0.0.1:9090 --pings 20 --log-pings", beside=("configs/bluerov2.yaml",)),
    Run(VIEW + r"oculus --out out-oculus", until=PICTURE, beside=("configs/bluerov2.yaml",)),
    Run(VIEW + r"ping1d --udp 127.0.0.1:9090 (--out out|--range 20 --gain 3)", until=PROGRESS, beside=("configs/demo-ping1d.yaml",)),
    Run(VIEW + r"ping1d --udp 127.0.0.1:9090 --pings 50 --log-pings", beside=("configs/demo-ping1d.yaml",)),
    Run(VIEW + r"dvl_a50 --tcp 127.0.0.1:16171 .*", beside=("configs/demo-dvl_a50.yaml",)),
    Run(VIEW + r"sonar3d15 --head 127.0.0.5 --port 8080 --interface 127.0.0.1 (--pings 20 )?--out out", until="ls out/shot-last.png",
        beside=("configs/demo-sonar3d15.yaml",)),
    Run(VIEW + r"sonar3d15 --head 192.168.2.96 .*", codes=(1,)),  # no interface here leads to the multicast group
    Run(COMPARE + r"out/.*", before=MAKE_LOG + " && mkdir -p out other && cp made/ping_000000.png out/polar-last.png && "
                                               "cp made/ping_000001.png other/polar-last.png"),
    Run(COMPARE + r"dump/.*", beside=("dump.yaml",), before="sonarview --range 3 --pings 16 --quiet"),
    Run(COMPARE + r"turn.jsonl.*", before=TURNS),
    Run(r"PYTHONPATH=clients/python python3 -m sonard_client.to_dataset pings more .*",
        before="head -n 2 harbour.csv > way.csv && for folder in pings more; do sonard render harbour.yaml --trajectory way.csv "
               "--out $folder --truth; done"),
    Run(CAST + r"(configs/trajectories/docking_demo.csv( --loop)?|FILE|survey.tum .*)", until=POSES_ARRIVE, beside=GEMINI),
    Run(CAST + r"dive.csv --tcp --to 10.61.19.200:14601 .*", until="test -s taken", addresses=VEHICLE, before=TAKE_POSES),
    Run(CAST + r"dive.csv --tcp --to 127.0.0.1:14601 .*", before=TAKE_POSES),
    # Scripts
    Run(r"sonard check harbour.yaml\nsonard run harbour.yaml &\n.*"),
    Run(r"sed 's/harbour.sdf/wreck.sdf/' harbour.yaml > wreck.yaml\n.*"),
    Run(r"unshare --map-root-user --net .*"),
    Run(r"sonard run configs/lock-step.yaml &\nPYTHONPATH=.*"),
]

# The servers of a command start before it and end after it.
SCRIPT = """
ip link set lo up
{addresses}
{servers}
{before}
{command}
"""
UNTIL = """{run} > output 2>&1 &
command=$!
met=
for k in $(seq 900); do
  {{ {until}
  }} > /dev/null 2>&1 && met=1 && break
  kill -0 $command 2> /dev/null || break
  sleep 0.1
done
kill -TERM $command 2> /dev/null
wait $command
code=$?
cat output
[[ -n $met || $code != 0 ]] || echo "it ended, or went on for 90 s, without this: {shown}"
[[ -n $met || $code != 0 ]] || exit 98
exit $code
"""
TO_THE_END = "timeout --signal=TERM --kill-after=20 {patience} {run}"
SERVER = """
sonard run {config} > server{number}.log 2>&1 &
servers="$servers $!"
timeout 110 sh -c 'until grep -qs "sonard ready" server{number}.log; do sleep 0.1; done' || {{ cat server{number}.log; exit 99; }}
"""


def block_of(document, language, place):
    found = [lines for _, name, lines in blocks((ROOT / document).read_text(encoding="utf-8")) if name == language]
    return "\n".join(found[place]) + "\n"


def filled_in(text):
    """Without placeholders and the brackets around optional parts."""
    text = re.sub(r"\[--gpu-device D\]", "", text).replace("[", "").replace("]", "") if re.match(r"sonard \w+ .*\[", text) else text
    for word, stands_for in PLACEHOLDERS.items():
        text = re.sub(rf"(?<![\w<-]){re.escape(word)}(?![\w>=])", stands_for, text)
    return text


def rule_of(text):
    return [rule for rule in RULES if re.fullmatch(rule.pattern, text, re.S)]


class Documentation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.found = commands(ROOT)

    def test_every_command_is_run_or_listed(self):
        self.assertGreater(len(self.found), 150)
        for command in self.found:
            with self.subTest(str(command)):
                rules = rule_of(command.text)
                self.assertEqual(len(rules), 1, f"{command} has {len(rules)} rules in commands_test.py, expected one: how it is run, "
                                                "or why not")
        for rule in RULES:
            self.assertTrue(any(rule in rule_of(command.text) for command in self.found), f"nothing matches {rule.pattern}")

    def test_options_that_are_mentioned_exist(self):
        for text in {command.text for command in self.found if isinstance(rule_of(command.text)[0], Mention)}:
            *program, option = text.split()
            done = subprocess.run([os.path.join(PROGRAMS, program[0]), *program[1:], "--help"], capture_output=True, text=True,
                                  timeout=PATIENCE_S, check=True)
            self.assertRegex(done.stdout, rf"(^|[ ,]){option}\b", text)

    def test_commands_run_as_printed(self):
        runs = {}
        for command in self.found:
            rule = rule_of(command.text)[0]
            if isinstance(rule, Run):
                runs.setdefault(command.text.removeprefix("build/release/bin/"), (command, rule))
        self.assertGreater(len(runs), 50)
        with tempfile.TemporaryDirectory() as folder:
            shared = pathlib.Path(folder) / "configs"  # a copy, in case that something writes there
            shutil.copytree(ROOT / "configs", shared)
            with concurrent.futures.ThreadPoolExecutor(max_workers=2 * len(os.sched_getaffinity(0))) as pool:
                for command, complaint in pool.map(lambda one: self.complaint(folder, *one), runs.values()):
                    with self.subTest(str(command)):
                        self.assertEqual(complaint, "")

    @staticmethod
    def complaint(folder, command, rule):
        """(command, error)"""
        place = pathlib.Path(tempfile.mkdtemp(dir=folder))
        (place / "build" / "release").mkdir(parents=True)
        (place / "build" / "release" / "bin").symlink_to(PROGRAMS)
        (place / "configs").symlink_to(pathlib.Path(folder) / "configs")
        (place / "clients").symlink_to(ROOT / "clients")
        for name, block in FILES.items():
            (place / name).write_text(block_of(*block), encoding="utf-8")
        for name, original in LIKE.items():
            text = (ROOT / original).read_text(encoding="utf-8")
            if name.endswith(".tum"):  # the same columns without a header, and with spaces
                text = text.partition("\n")[2].replace(",", " ")
            (place / name).write_text(text.replace("file: worlds/", "file: configs/worlds/"), encoding="utf-8")
        (place / "clean.yaml").write_text(block_of(*FILES["harbour.yaml"]) + block_of("docs/offline.md", "yaml", 0), encoding="utf-8")
        (place / "meshes").mkdir()
        (place / "meshes" / "wreck.stl").write_text(WRECK, encoding="utf-8")
        (place / "two-heads.yaml").write_text(TWO_HEADS, encoding="utf-8")
        (place / "dump.yaml").write_text(DUMP, encoding="utf-8")
        (place / "command.sh").write_text(filled_in(command.text) + "\n", encoding="utf-8")
        is_script = "\n" in command.text or "=" in command.text.split()[0]
        run = "bash command.sh" if is_script else filled_in(command.text)
        script = SCRIPT.format(addresses="".join(f"ip address add {address}/24 dev lo\n" for address in rule.addresses),
                               servers="".join(SERVER.format(config=config, number=k) for k, config in enumerate(rule.beside)),
                               before=rule.before,
                               command=UNTIL.format(run=run, until=rule.until, shown=re.sub(r"[^\w /.*-]", " ", rule.until))
                               if rule.until else TO_THE_END.format(patience=PATIENCE_S, run=run))
        path = f"{PROGRAMS}:{os.path.dirname(sys.executable)}:{os.environ['PATH']}"  # python3 is this one
        environment = {**os.environ, "PATH": path, "HOME": str(place), "XDG_CACHE_HOME": str(place)}
        done = subprocess.run(["unshare", "--net", "--pid", "--fork", "--kill-child", "--mount-proc", "bash", "-c", script], cwd=place,
                              env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True,
                              errors="replace", timeout=2 * PATIENCE_S, check=False)
        if done.returncode in rule.codes or (done.returncode == SOME_LOST and re.search(r"[1-9]\d* (pings|lines)", done.stdout)):
            return command, ""
        return command, f"exit status {done.returncode}, expected {rule.codes}:\n{done.stdout[-3000:]}"


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard, sonarview and posecast")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    PROGRAMS = os.path.abspath(arguments.programs)
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
