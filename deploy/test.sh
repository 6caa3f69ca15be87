#!/usr/bin/env bash
# Installs the dependencies, builds what CI builds and runs the whole test suite.
# usage: test.sh [CTEST-ARGUMENTS...]     e.g. test.sh -L unit
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

"$source_dir/deploy/install-deps.sh" test
cd "$source_dir"
cmake --preset ci
cmake --build --preset ci --parallel "$(nproc)"
exec ctest --preset ci "$@"
