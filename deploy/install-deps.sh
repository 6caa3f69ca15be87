#!/usr/bin/env bash
# Installs what depthfarm needs on Debian 12 (why each package: docs/dependencies.md).
# usage: install-deps.sh [build|test]     build: compile and run (default); test: the test suite as well
set -euo pipefail

build_packages=(
  g++ cmake ninja-build pkg-config
  libeigen3-dev libhwy-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev
  libzmq3-dev cppzmq-dev
  libprotobuf-dev protobuf-compiler
  libssl-dev libzstd-dev libsqlite3-dev
  libavcodec-dev libavformat-dev libavutil-dev
  nlohmann-json3-dev libcli11-dev libspdlog-dev
)
test_packages=(
  libgtest-dev libgmock-dev libboost-graph-dev libbenchmark-dev
  libopencv-calib3d-dev python3-matplotlib python3-scipy
)

case "${1:-build}" in
  build) packages=("${build_packages[@]}") ;;
  test) packages=("${build_packages[@]}" "${test_packages[@]}") ;;
  *) echo "usage: install-deps.sh [build|test]" >&2; exit 2 ;;
esac

# A machine that has everything already needs neither network nor root.
missing=()
for package in "${packages[@]}"; do
  installed=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$installed" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "all ${#packages[@]} packages are installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then as_root=(sudo); fi
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
