#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Unpacks the packages of Debian arm64 for building sonard, for cmake/toolchains/debian_arm64.cmake:
#   docker/arm64_sysroot.sh FOLDER
# Uses this machine's mirrors and release. It installs no package, so it needs neither an emulator nor root.
set -euo pipefail
(($# == 1)) || { echo "Usage: docker/arm64_sysroot.sh FOLDER" >&2; exit 64; }
here=$(dirname "$(realpath "$0")")
root=$(realpath -m "$1")
apt=$root.apt
mkdir -p "$root" "$apt"/{etc,lists/partial,archives/partial}
touch "$apt/status"

# The first name in each line of section [build] that arm64 has, libraries only; tools run on this machine.
export APT_CONFIG=$apt/etc/apt.conf
cat > "$APT_CONFIG" <<END
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
Dir::State::status "$apt/status";
Dir::State::lists "$apt/lists";
Dir::Cache::archives "$apt/archives";
Dir::Cache::pkgcache "";
Dir::Cache::srcpkgcache "";
APT::Sandbox::User "root";
END
apt-get update -qq
packages=(libc6-dev libstdc++-12-dev libgtest-dev libgmock-dev)
while read -r line; do
  for name in $(tr '|' ' ' <<<"${line#optional }"); do
    if [[ $name == lib*-dev || $name == nlohmann-json3-dev ]] && apt-cache show --no-all-versions "$name" > /dev/null 2>&1; then
      packages+=("$name")
      break
    fi
  done
done < <(awk '/^\[/ { inside = ($0 == "[build]"); next } inside && NF && !/^#/' "$here/packages.txt")
apt-get install -y -qq --no-install-recommends --download-only "${packages[@]}" > /dev/null
for package in "$apt"/archives/*.deb; do
  dpkg-deb -x "$package" "$root"
done

# Does the work of the packages' scripts, and makes absolute paths relative to the arm64 root.
libraries=$root/usr/lib/aarch64-linux-gnu
ln -sf lapack/liblapack.so.3 blas/libblas.so.3 "$libraries"
find "$root/usr/lib" "$root/lib" -type l | while read -r link; do
  target=$(readlink "$link")
  [[ $target != /* || ! -e $root$target ]] || ln -sfn "$root$target" "$link"
done
grep -rlZ /usr/ "$libraries/cmake" | xargs -0 sed -i -E "s#([\";]|>:)(/usr/(lib/aarch64-linux-gnu|include))#\\1$root\\2#g"
