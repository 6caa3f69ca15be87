#!/usr/bin/env bash
# Simulates farms with faults until so many attempts of tasks were made (docs/reliability.md); ends badly if a seed failed.
# usage: simulate.sh [ATTEMPTS] [FIRST-SEED]     default: 1000000 attempts from seed 1
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

"$source_dir/deploy/install-deps.sh" test
cd "$source_dir"
cmake --preset ci
cmake --build --preset ci --parallel "$(nproc)" --target depthfarm-simulation
exec build/ci/tests/depthfarm-simulation --attempts "${1:-1000000}" --first "${2:-1}"
