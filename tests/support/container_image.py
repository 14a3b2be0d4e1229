# SPDX-License-Identifier: Apache-2.0
"""Builds docker/Dockerfile with buildah in a storage of its own. Needs root, buildah, podman and debootstrap.

    container_image.py FOLDER ARCHITECTURE OUT.tar [PACKAGE.deb]

writes the image as an OCI archive; FOLDER has the storage. With a package for the image's release, it compiles nothing.
"""

import os
import pathlib
import shutil
import subprocess
import sys

from fresh_system import make_fresh_system

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
BASE = "docker.io/library/debian:12-slim"  # as the Dockerfile says


def set_up_engines(folder):
    """Storage and networks below `folder`, and settings that need neither systemd nor a kernel with overlays."""
    (folder / "storage.conf").write_text(f'[storage]\ndriver = "vfs"\ngraphroot = "{folder}/storage"\nrunroot = "{folder}/run"\n')
    (folder / "containers.conf").write_text(
        '[containers]\ndefault_ulimits = ["nofile=1024:1024", "nproc=20000:20000"]\nlog_driver = "k8s-file"\n'
        f'[engine]\nruntime = "runc"\ncgroup_manager = "cgroupfs"\nevents_logger = "file"\ntmp_dir = "{folder}/tmp"\n'
        f'[network]\nnetwork_backend = "netavark"\nnetwork_config_dir = "{folder}/networks"\n')
    os.environ.update(CONTAINERS_CONF=str(folder / "containers.conf"), CONTAINERS_STORAGE_CONF=str(folder / "storage.conf"))


def with_package(folder, package):
    """Options that give the Dockerfile a package in place of its stage `build`."""
    built = folder / "context" / "src" / "build" / "release"
    built.mkdir(parents=True)
    shutil.copy(package, built / "sonard_release.deb")
    return ("--build-context", f"build={folder / 'context'}")


def build_image(folder, options=()):
    """Tags the image `sonard`. Its base is made from this machine's mirror."""
    base = folder / "base"
    architecture = options[options.index("--arch") + 1] if "--arch" in options else None
    make_fresh_system(base, "bookworm" if architecture else None, architecture)
    with subprocess.Popen(["tar", "-C", base, "-c", "."], stdout=subprocess.PIPE) as tree:
        subprocess.run(["podman", "import", *options[:2], "-", BASE], stdin=tree.stdout, check=True, capture_output=True)
    shutil.rmtree(base)
    commit = subprocess.run(["git", "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"], cwd=REPOSITORY, check=True,
                            stdout=subprocess.PIPE, text=True).stdout.strip()
    subprocess.run(["buildah", "bud", "--pull-never", "--isolation=chroot", "--format", "docker", "--build-arg", f"COMMIT={commit}",
                    *options, "--tag", "sonard", "--file", REPOSITORY / "docker" / "Dockerfile", REPOSITORY], check=True)


def main():
    folder, architecture, out = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    folder.mkdir(parents=True, exist_ok=True)
    set_up_engines(folder)
    package = with_package(folder, sys.argv[4]) if len(sys.argv) > 4 else ()
    build_image(folder, options=("--arch", architecture, "--timestamp", os.environ["SOURCE_DATE_EPOCH"], *package))
    subprocess.run(["buildah", "push", "--format", "oci", "sonard", f"oci-archive:{out}"], check=True)


if __name__ == "__main__":
    main()
