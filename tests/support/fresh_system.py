# SPDX-License-Identifier: Apache-2.0
"""Creates a Debian in a folder, from this machine's mirror. Needs root and debootstrap.

    fresh_system.py FOLDER CODENAME ARCHITECTURE
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys


def make_fresh_system(root, codename=None, architecture=None):
    """Installs Debian in the folder `root`, with this machine's name resolution and certificates. Without a codename and
    an architecture, it has those of this machine. An architecture of another machine needs qemu-user (binfmt_misc)."""
    here = re.search("^VERSION_CODENAME=(.*)$", pathlib.Path("/etc/os-release").read_text(encoding="utf-8"), re.MULTILINE).group(1)
    subprocess.run(["debootstrap", "--variant=minbase", "--include=ca-certificates", *([f"--arch={architecture}"] if architecture else []),
                    codename or here, root, apt_mirror(here)], check=True, stdout=subprocess.DEVNULL)
    for file in ("/etc/resolv.conf", "/etc/hosts", "/etc/ssl/certs/ca-certificates.crt"):
        if os.path.exists(file):
            shutil.copy(file, pathlib.Path(root) / file.lstrip("/"))


def apt_mirror(codename):
    """The address of Debian's main packages in this machine's apt."""
    listed = subprocess.run(["apt-get", "indextargets", "--format", "$(CODENAME) $(COMPONENT) $(REPO_URI)", "Created-By: Packages"],
                            check=True, capture_output=True, text=True).stdout
    for line in listed.splitlines():
        name, component, uri = line.split(maxsplit=2)
        if name == codename and component == "main" and "security" not in uri:
            return uri
    raise SystemExit(f"this machine's apt has no source for {codename} main")


if __name__ == "__main__":
    make_fresh_system(*sys.argv[1:])
