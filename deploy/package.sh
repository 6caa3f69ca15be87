#!/usr/bin/env bash
# Builds the Debian packages into build/packages: depthfarm, depthfarm-worker, depthfarm-coordinator, libdepthfarm-dev and
# python3-depthfarm. Times in them are those of the last commit.
# usage: package.sh [--check-reproducible]     builds what is committed twice, elsewhere too, and compares the bytes
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$source_dir"
deploy/install-deps.sh package

# The time that is in packages and manuals: that of the sources.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || stat -c %Y CHANGELOG.md)}
export SOURCE_DATE_EPOCH LC_ALL=C.UTF-8
umask 022

# package FOLDER: builds the sources in FOLDER
package() (
  cd "$1"
  cmake --preset package
  cmake --build --preset package --parallel "$(nproc)"
  rm -rf build/packages
  cpack --config build/package/CPackConfig.cmake -B build/packages
  rm -rf build/packages/_CPack_Packages
)

package "$source_dir"
if [ "${1:-}" = --check-reproducible ]; then
  copy=$(mktemp -d)
  trap 'rm -rf "$copy"' EXIT
  git archive HEAD | tar -x -C "$copy"
  package "$copy"
  for file in "$source_dir"/build/packages/*.deb; do
    cmp "$file" "$copy/build/packages/$(basename "$file")"
  done
  echo "both builds made the same bytes"
fi
sha256sum build/packages/*.deb
