#!/usr/bin/env bash
# Installs what depthfarm needs on Debian 12 (why each package: docs/dependencies.md).
# usage: install-deps.sh [build|test|package|fuzz|arm64 [FOLDER]]
#   build   compile and run (default)
#   test    the test suite as well
#   package build Debian packages
#   fuzz    that of test, and what deploy/fuzz.sh needs
#   arm64   cross builds for 64-bit ARM: compiler and emulator, and the libraries of `test` for arm64 in FOLDER (default:
#           build/sysroot-arm64, where the preset arm64 looks; 1.1 GB)
set -euo pipefail

build_tools=(cmake ninja-build pkg-config protobuf-compiler help2man)
build_libraries=(
  libeigen3-dev libhwy-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev libopenexr-dev
  libzmq3-dev cppzmq-dev
  libprotobuf-dev
  libssl-dev libzstd-dev libdeflate-dev libsqlite3-dev
  libavcodec-dev libavformat-dev libavutil-dev
  nlohmann-json3-dev libcli11-dev libspdlog-dev
  prometheus-cpp-dev libcpp-httplib-dev
)
# Hashing on vectors, which is for x86-64.
if [ "$(dpkg --print-architecture)" = amd64 ]; then build_here=(libipsec-mb-dev); else build_here=(); fi
test_tools=(python3-matplotlib python3-scipy slurm-wlm munge openssh-server systemd fish zsh mandoc
  iproute2 nftables strace python3-kubernetes)
python_packages=(pybind11-dev python3-dev python3-numpy)
test_libraries=(libgtest-dev libgmock-dev libboost-graph-dev libbenchmark-dev libopencv-calib3d-dev)
fuzz_tools=(clang libclang-rt-14-dev)
arm64_tools=(g++-aarch64-linux-gnu mmdebstrap qemu-user)

build_packages=(g++ "${build_tools[@]}" "${build_libraries[@]}" "${build_here[@]}")
test_packages=("${build_packages[@]}" "${test_tools[@]}" "${test_libraries[@]}" "${python_packages[@]}")
case "${1:-build}" in
  build) packages=("${build_packages[@]}") ;;
  test) packages=("${test_packages[@]}") ;;
  package) packages=("${build_packages[@]}" "${python_packages[@]}" dpkg-dev file) ;;
  fuzz) packages=("${test_packages[@]}" "${fuzz_tools[@]}") ;;
  arm64) packages=("${build_tools[@]}" "${arm64_tools[@]}") ;;
  *) echo "usage: install-deps.sh [build|test|package|fuzz|arm64 [FOLDER]]" >&2; exit 2 ;;
esac

install_missing() {
  # A machine that has everything already needs neither network nor root.
  missing=()
  for package in "${packages[@]}"; do
    installed=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$installed" = installed ] || missing+=("$package")
  done
  if [ ${#missing[@]} -eq 0 ]; then
    echo "all ${#packages[@]} packages are installed"
    return
  fi

  as_root=()
  if [ "$(id -u)" -ne 0 ]; then as_root=(sudo); fi
  export DEBIAN_FRONTEND=noninteractive
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# Unpacked, not installed: nothing of the host changes, and no script of a package runs.
make_sysroot() {
  local folder=$1 list
  list=$(printf '%s\n' libc6-dev "${build_libraries[@]}" "${test_libraries[@]}")
  if [ -e "$folder" ]; then
    if [ "$(cat "$folder/packages.txt" 2>/dev/null || true)" = "$list" ]; then
      echo "$folder holds the arm64 packages"
      return
    fi
    echo "install-deps.sh: $folder is something else, unfinished, or of other packages: remove it first" >&2
    exit 1
  fi
  mkdir -p "$(dirname "$folder")"
  mmdebstrap --variant=extract --architectures=arm64 --include="$(tr '\n' ',' <<<"$list")" bookworm "$folder"
  # Links of the packages are meant for a system whose root this folder is.
  find "$folder" -type l -lname '/*' -print0 | while IFS= read -r -d '' link; do
    ln -sfnr "$folder$(readlink "$link")" "$link"
  done
  echo "$list" >"$folder/packages.txt"
}

install_missing
if [ "${1:-build}" = arm64 ]; then
  make_sysroot "${2:-$(cd "$(dirname "$0")/.." && pwd)/build/sysroot-arm64}"
fi
