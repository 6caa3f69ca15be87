#!/usr/bin/env bash
# From a fresh Debian 12 to depth maps: installs the dependencies, builds the release, runs the demo.
# usage: demo.sh [DIR]     DIR: where the demo's results go, default ./depthfarm-demo
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
output_dir=$(realpath -m "${1:-depthfarm-demo}")

"$source_dir/deploy/install-deps.sh" build
cd "$source_dir"
cmake --preset release
cmake --build --preset release --parallel "$(nproc)"
exec "$source_dir/build/release/bin/depthfarm" demo -o "$output_dir"
