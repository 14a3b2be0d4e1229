# SPDX-License-Identifier: Apache-2.0
"""The shell text in the Markdown of this repository: blocks of commands, commands within sentences, and files to save."""

import dataclasses
import pathlib
import re

SHELL = ("", "sh", "bash", "console", "shell")
# A line of a block is a command if it begins with one of these. A block without such lines is output or a drawing.
PROGRAMS = ("sonard", "sonarview", "posecast", "roscast", "./run", "./test", "build/", "tests/", "docker", "clients/", "configs/",
            "hooks/", "cmake", "ctest", "git", "sudo", "apt", "pip", "npm", "python3", "podman", "kubectl", "ip", "systemctl",
            "mkdocs", "doxygen", "protoc", "ros2", "rosrun", "roslaunch", "rostopic", "rosdep", "colcon", "ign", "gz", "tshark", "tcpdump",
            "editcap", "wireshark", "curl", "socat", "nc", "ss", "sysctl", "unshare", "export", "for", "while", "cd", "cp", "ln",
            "mkdir", "kill", "cmp", "wait", "PYTHONPATH=", "SONARD", "chrt", "perf", "nvidia-smi", "qemu", "ffmpeg", "ethtool", "seed=",
            "umask", "chmod", "modprobe", "setcap", "source", ".", "xvfb-run", "world=", "set", "screen", "stty", "sim_vehicle.py")
# In sentences, only a program of this repository with its arguments is a command: `sonard render` alone is a name.
INLINE = re.compile(r"^(build/release/bin/)?(sonard (?!ready)(\w+ \S|--|demo|selftest)|sonarview (\w+ \S|--)|posecast \S)")


@dataclasses.dataclass(frozen=True)
class Command:
    """A command as printed: continued lines joined, comments behind # removed."""

    file: str
    line: int
    text: str

    def __str__(self):
        return f"{self.file}:{self.line}: {self.text}"


def blocks(text):
    """(line, language, lines) of each block, fenced or indented; an indented one has no language."""
    lines = text.split("\n")
    at = 0
    while at < len(lines):
        fence = re.match(r"^( *)```(\w*)", lines[at])
        if fence:
            end = next(k for k in range(at + 1, len(lines)) if lines[k].strip() == "```")
            indent = len(fence[1])
            yield at + 2, fence[2], [line[indent:] for line in lines[at + 1:end]]
            at = end + 1
        elif re.match(r"^    +\S", lines[at]) and (at == 0 or lines[at - 1] == ""):
            end = at
            while end < len(lines) and (lines[end].startswith("    ") or lines[end] == ""):
                end += 1
            body = lines[at:end]
            indent = min(len(line) - len(line.lstrip()) for line in body if line)
            yield at + 1, None, [line[indent:] for line in body]
            at = end
        else:
            at += 1


def is_command(line):
    if line.startswith("sonard ready"):
        return False  # the log
    word = line.split(" ")[0]
    return any(word == program or (program[-1] in "/=" or program == "SONARD") and word.startswith(program) for program in PROGRAMS)


def commands_of_block(line_number, lines):
    """(line, text) of each command; continued lines and the bodies of loops and quotes belong to the first."""
    if not any(is_command(line.removeprefix("$ ")) for line in lines) or lines[0].startswith("#!"):
        return
    lines = [re.sub(r"(^|\s+)#( .*)?$", "", line) for line in lines]
    if any(line.endswith(" &") for line in lines):
        yield line_number, "\n".join(line for line in lines if line)  # a script
        return
    if lines[0].startswith("$ "):  # a dialogue: only what is typed
        lines = [line.removeprefix("$ ") if line.startswith("$ ") else "" for line in lines]
    at = 0
    while at < len(lines):
        begin, text = at, lines[at]
        at += 1
        while at < len(lines) and (text.endswith("\\") or text.count("'") % 2 == 1 or
                                   re.match(r"^(for|while|if) ", text) and not re.search(r"\b(done|fi)\b", text)):
            text = (text[:-1].rstrip() + " " + lines[at].lstrip()) if text.endswith("\\") else text + "\n" + lines[at]
            at += 1
        if text and (is_command(text) or text.split(" ")[0] == text.split(" ")[0].lower()):
            yield line_number + begin, text


def commands(root):
    """All commands of README.md and docs."""
    found = []
    root = pathlib.Path(root)
    for path in [root / "README.md", *sorted((root / "docs").rglob("*.md"))]:
        text = path.read_text(encoding="utf-8")
        name = str(path.relative_to(root))
        for line, language, lines in blocks(text):
            if language is None or language in SHELL:
                found += [Command(name, number, one) for number, one in commands_of_block(line, lines)]
        outside = re.sub(r"^( *)```.*?^\1```$", lambda block: re.sub(r"[^\n]", "", block[0]), text, flags=re.M | re.S)
        for span in re.finditer(r"`([^`\n]+)`", outside):
            if INLINE.match(span[1]):
                found.append(Command(name, outside[:span.start()].count("\n") + 1, span[1]))
    return found
