#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the software bill of materials of the Debian package as SPDX 2.3 in JSON.

    make_sbom.py VERSION OUT.spdx.json PROGRAM...

It lists the Debian packages of the shared libraries that the programs link (their NEEDED entries, not the libraries that
those link), and of the header-only libraries that are compiled into them. Needs readelf, ldd and dpkg-query.
"""

import hashlib
import json
import os
import re
import subprocess
import sys
import time

# Libraries of headers only; their code is part of the programs.
COMPILED_IN = {"libboost-dev": "Boost", "libcli11-dev": "CLI11", "libglm-dev": "GLM", "nlohmann-json3-dev": "JSON for Modern C++"}
LICENCE = "Apache-2.0"


def output(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env={**os.environ, "LC_ALL": "C"}).stdout


def linked_libraries(program):
    """Paths of the libraries in the NEEDED entries of a program."""
    needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "--dynamic", program)))
    found = dict(re.findall(r"^\s*(\S+) => (\S+)", output("ldd", program), re.MULTILINE))
    return [found[name] for name in sorted(needed) if name in found]


def owner(path):
    """The Debian package of a file. Because /usr is merged, it tries both forms of a path."""
    for candidate in (path, os.path.realpath(path), path.removeprefix("/usr"), "/usr" + path):
        done = subprocess.run(["dpkg-query", "--search", candidate], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        if done.returncode == 0:
            return done.stdout.split(": ")[0].split(",")[0]
    raise SystemExit(f"make_sbom.py: {path} does not belong to a Debian package")


def spdx_package(name):
    fields = output("dpkg-query", "--show", "--showformat=${binary:Package}\t${Version}\t${Architecture}\t${source:Package}\t${Homepage}\n", name)
    package, version, architecture, source, homepage = fields.splitlines()[0].split("\t")
    package = package.split(":")[0]
    return {
        "SPDXID": "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", package),
        "name": package,
        "versionInfo": version,
        "supplier": "Organization: Debian",
        "sourceInfo": f"built from the Debian source package {source}",
        "downloadLocation": "NOASSERTION",
        **({"homepage": homepage} if homepage else {}),
        "filesAnalyzed": False,
        "licenseConcluded": "NOASSERTION",
        "licenseDeclared": "NOASSERTION",
        "copyrightText": "NOASSERTION",
        "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                          "referenceLocator": f"pkg:deb/debian/{package}@{version.replace('+', '%2B').replace(':', '%3A')}?arch={architecture}"}],
    }


def bill(version, programs):
    own = {"SPDXID": "SPDXRef-sonard", "name": "sonard", "versionInfo": version, "supplier": "NOASSERTION",
           "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "licenseConcluded": LICENCE, "licenseDeclared": LICENCE,
           "copyrightText": "Copyright 2026 The sonard developers", "primaryPackagePurpose": "APPLICATION"}
    linked = sorted({owner(path) for program in programs for path in linked_libraries(program)})
    packages, relationships = [own], []
    for kind, names in (("DYNAMIC_LINK", linked), ("STATIC_LINK", sorted(COMPILED_IN))):
        for name in names:
            package = spdx_package(name)
            if name in COMPILED_IN:
                package["summary"] = COMPILED_IN[name]
            packages.append(package)
            relationships.append({"spdxElementId": own["SPDXID"], "relationshipType": kind, "relatedSpdxElement": package["SPDXID"]})
    content = {"packages": packages, "relationships": [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES",
                                                        "relatedSpdxElement": own["SPDXID"]}, *relationships]}
    digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]
    created = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", "0"))))
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"sonard-{version}",
            "documentNamespace": f"https://sonard.dev/spdx/sonard-{version}-{digest}",
            "creationInfo": {"created": created, "creators": ["Tool: make_sbom.py"]}, **content}


def main():
    if len(sys.argv) < 4:
        raise SystemExit(__doc__)
    version, out, *programs = sys.argv[1:]
    with open(out, "w", encoding="utf-8") as file:
        json.dump(bill(version, programs), file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    main()
