#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Carries out docker/Dockerfile without a container engine, and runs what comes out.

  sudo docker/prove_in_chroot.py --work DIR [--keep]

Each stage becomes a folder made by debootstrap from the mirror this machine's apt uses; RUN, COPY, ENV, WORKDIR and USER
are done there in chroots with their own mount and process namespaces. Then the daemon is started as the image would
start it, in a network namespace that has only loopback and 10.61.19.200: once with the demo configuration, from which
sonarview takes three pings, and once with the one of the compose file.
Needs root, debootstrap, git, iproute2 and the Debian release that the Dockerfile names as its base.
"""

import argparse
import json
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import sys
import time

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
CODENAMES = {"debian:12-slim": "bookworm"}
READY_DEADLINE_S = 120.0


def instructions(text):
    """(keyword, rest) of each logical line."""
    joined = ""
    for line in text.splitlines():
        if not joined and (not line.strip() or line.lstrip().startswith("#")):
            continue
        joined += line.rstrip("\\") if line.endswith("\\") else line
        if not line.endswith("\\"):
            keyword, _, rest = joined.strip().partition(" ")
            yield keyword.upper(), rest.strip()
            joined = ""


def apt_mirror(codename):
    """The repository address from which this machine's apt takes Debian's main packages."""
    listed = subprocess.run(["apt-get", "indextargets", "--format", "$(CODENAME) $(COMPONENT) $(REPO_URI)", "Created-By: Packages"],
                            check=True, capture_output=True, text=True).stdout
    for line in listed.splitlines():
        name, component, uri = line.split(maxsplit=2)
        if name == codename and component == "main" and "security" not in uri:
            return uri
    raise SystemExit(f"this machine's apt has no source for {codename} main")


class Stage:
    """One build stage: a root folder and the settings its next command runs under."""

    def __init__(self, root):
        self.root = root
        self.directory, self.user, self.environment = "/", "root", {}
        self.entrypoint, self.command = [], []

    def argv(self, command, network=True):
        """How to run `command` (a list) inside, in namespaces of its own."""
        variables = {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", **self.environment}
        inside = ["env", "-i", *(f"{k}={v}" for k, v in variables.items()), "sh", "-c", 'cd "$0" && exec "$@"', self.directory, *command]
        chroot = ["chroot", f"--userspec={self.user}:{self.user}", str(self.root), *inside]
        setup = f"mount -t proc proc {shlex.quote(str(self.root / 'proc'))} && "
        if not network:
            setup += ("ip link set lo up && ip link add eth0 type veth peer name far_end && ip link set far_end up && "
                      "ip address add 10.61.19.200/24 brd + dev eth0 && ip link set eth0 up && ")
        return ["unshare", "--mount", "--pid", "--fork", "--kill-child", *([] if network else ["--net"]), "sh", "-c",
                setup + "exec " + shlex.join(chroot)]

    def run(self, command):
        subprocess.run(self.argv(["/bin/sh", "-c", command]), check=True)


def copy(stage, stages, rest):
    words = shlex.split(rest)
    source_root = REPOSITORY
    if words[0].startswith("--from="):
        source_root = stages[words.pop(0).removeprefix("--from=")].root
    *sources, target = words
    target_path = stage.root / target.lstrip("/")
    for source in sources:
        if source_root == REPOSITORY and source == ".":  # what .dockerignore lets through, near enough
            tracked = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=REPOSITORY,
                                     check=True, capture_output=True).stdout.split(b"\0")
            for name in filter(None, tracked):
                origin, to = REPOSITORY / os.fsdecode(name), target_path / os.fsdecode(name)
                if origin.is_file():
                    to.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy2(origin, to)
            continue
        origin = source_root / source.lstrip("/")
        if origin.is_dir():
            shutil.copytree(origin, target_path, symlinks=True, dirs_exist_ok=True)
        else:
            to = target_path / origin.name if target.endswith("/") else target_path
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(origin, to)


def new_stage(base, work, name):
    if base not in CODENAMES:
        raise SystemExit(f"no debootstrap equivalent is known for {base}")
    codename = CODENAMES[base]
    clean = work / codename
    if not clean.is_dir():
        partial = work / f"{codename}.partial"
        shutil.rmtree(partial, ignore_errors=True)
        subprocess.run(["debootstrap", "--variant=minbase", codename, partial, apt_mirror(codename)], check=True)
        partial.rename(clean)
    root = work / name
    shutil.rmtree(root, ignore_errors=True)
    subprocess.run(["cp", "-a", clean, root], check=True)
    for file in ("/etc/resolv.conf", "/etc/hosts"):
        shutil.copy(file, root / file.lstrip("/"))
    return Stage(root)


def build(work):
    stages, stage = {}, None
    for keyword, rest in instructions((REPOSITORY / "docker" / "Dockerfile").read_text()):
        print(f"==> {keyword} {rest}", flush=True)
        if keyword == "FROM":
            words = rest.split()
            name = words[2] if len(words) == 3 else "final"
            stage = stages[name] = new_stage(words[0], work, name)
        elif keyword == "RUN":
            stage.run(rest)
        elif keyword == "COPY":
            copy(stage, stages, rest)
        elif keyword == "WORKDIR":
            stage.directory = rest
            (stage.root / rest.lstrip("/")).mkdir(parents=True, exist_ok=True)
        elif keyword == "ENV":
            key, _, value = rest.partition("=")
            stage.environment[key] = value
        elif keyword == "USER":
            stage.user = rest
        elif keyword == "ENTRYPOINT":
            stage.entrypoint = json.loads(rest)
        elif keyword == "CMD":
            stage.command = json.loads(rest)
        elif keyword != "EXPOSE":
            raise SystemExit(f"Dockerfile instruction {keyword} is not known here")
    return stage


def prove_libraries(stage):
    for program in ("sonard", "sonarview", "posecast"):
        done = subprocess.run(stage.argv(["ldd", f"/usr/local/bin/{program}"]), check=True, capture_output=True, text=True)
        missing = [line.strip() for line in done.stdout.splitlines() if "not found" in line]
        print(f"==> {program}: {len(done.stdout.splitlines())} shared libraries, {len(missing)} missing")
        if missing:
            raise SystemExit("\n".join(missing))


def prove_serving(stage, arguments, client=None):
    """Starts the image's command, waits until it is ready, runs `client` beside it, ends it with SIGTERM; all must exit with 0."""
    print(f"==> {shlex.join(stage.entrypoint + arguments)} as {stage.user}", flush=True)
    log_path = stage.root.parent / "sonard.log"
    with open(log_path, "w") as log:
        process = subprocess.Popen(stage.argv(stage.entrypoint + arguments, network=False), stdout=log, stderr=subprocess.STDOUT)
    deadline = time.monotonic() + READY_DEADLINE_S
    while "sonard ready" not in log_path.read_text():
        if process.poll() is not None or time.monotonic() > deadline:
            process.kill()
            raise SystemExit(f"not ready:\n{log_path.read_text()}")
        time.sleep(0.1)
    daemon = deepest_descendant(process.pid)
    if client:
        subprocess.run(["nsenter", f"--net=/proc/{daemon}/ns/net", "chroot", f"--userspec={stage.user}", stage.root, *client],
                       check=True, timeout=READY_DEADLINE_S)
    os.kill(daemon, signal.SIGTERM)
    code = process.wait(timeout=20)
    print(log_path.read_text().rstrip())
    if code != 0:
        raise SystemExit(f"ended with exit code {code}")


def deepest_descendant(ancestor):
    """The daemon below unshare, by the number it has out here."""
    pid = ancestor
    while True:
        children = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        if not children:
            return pid
        pid = int(children[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for the stages, about 3 GB")
    parser.add_argument("--keep", action="store_true", help="leave the stages in place afterwards")
    options = parser.parse_args()
    if os.geteuid() != 0:
        raise SystemExit("chroot and debootstrap need root")
    options.work.mkdir(parents=True, exist_ok=True)
    stage = build(options.work.resolve())
    prove_libraries(stage)
    prove_serving(stage, stage.command, ["/usr/local/bin/sonarview", "--pings", "3", "--quiet"])
    prove_serving(stage, ["run", "configs/gemini-netns.yaml"])
    if not options.keep:
        for name in ("build", "final"):
            shutil.rmtree(options.work / name)
    print("==> every step of the Dockerfile worked, and its daemon served")
    return 0


if __name__ == "__main__":
    sys.exit(main())
