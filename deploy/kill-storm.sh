#!/usr/bin/env bash
# Kills and stops real workers and coordinators at random moments of real jobs; each job must give its bytes.
# usage: kill-storm.sh [KILLS] [SEED]     default: 100 disturbances, seed 1
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

"$source_dir/deploy/install-deps.sh" test
cd "$source_dir"
cmake --preset ci
cmake --build --preset ci --parallel "$(nproc)" --target system_test
export DEPTHFARM_STORM_KILLS="${1:-100}" DEPTHFARM_STORM_SEED="${2:-1}"
exec build/ci/tests/system_test --gtest_filter='KillStorm.*'
