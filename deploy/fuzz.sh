#!/usr/bin/env bash
# Builds the fuzz targets with clang and runs each for a while; prints a table, and where an input broke something keeps
# it and exits with 1.
# usage: fuzz.sh [--merge] [SECONDS] [TARGET...]     SECONDS of each target, default 60; TARGET: e.g. envelope; all
#   --merge    afterwards add to tests/fuzz/corpus what new code was reached with (look at its size before you commit it)
# environment: FUZZ_RSS_MB, default 1024: most memory of a target; FUZZ_JOBS: of the build
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$source_dir"

# Bounds of one input, which has at most max_len bytes (docs/reliability.md, Fuzzing).
max_len=4096
most_seconds=10      # until an input counts as a hang; slower than a second is counted too
malloc_mb=256        # of one allocation
rss_mb=${FUZZ_RSS_MB:-1024}

merge=false
if [ "${1:-}" = --merge ]; then merge=true; shift; fi
seconds=60
if [[ "${1:-}" =~ ^[0-9]+$ ]]; then seconds=$1; shift; fi
targets=("$@")

command -v clang++ > /dev/null || { echo "fuzz.sh: clang++ is missing: deploy/install-deps.sh fuzz installs it" >&2; exit 2; }
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz --parallel "${FUZZ_JOBS:-$(nproc)}" | tail -n 1
if [ ${#targets[@]} -eq 0 ]; then
  for corpus in tests/fuzz/corpus/*/; do targets+=("$(basename "$corpus")"); done
fi

out=build/fuzz/out
export OPENCV_LOG_LEVEL=SILENT  # it says of each damaged file that it is damaged
export ASAN_OPTIONS=allocator_may_return_null=0:detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1
failed=0
printf '%-18s %12s %10s %8s %8s %6s\n' target executions exec/s inputs peak-MB slow
for target in "${targets[@]}"; do
  program=build/fuzz/fuzz/fuzz-$target
  [ -x "$program" ] || { echo "fuzz.sh: there is no target '$target'" >&2; exit 2; }
  mkdir -p "$out/$target/corpus" "$out/$target/found"
  log=$out/$target/log
  status=0
  "$program" -max_total_time="$seconds" -max_len=$max_len -timeout=$most_seconds -report_slow_units=1 \
    -malloc_limit_mb=$malloc_mb -rss_limit_mb="$rss_mb" -print_final_stats=1 -artifact_prefix="$out/$target/found/" \
    "$out/$target/corpus" "tests/fuzz/corpus/$target" > "$log" 2>&1 || status=$?
  stat() { sed -n "s/^stat::$1: *//p" "$log" | tail -n 1; }
  printf '%-18s %12s %10s %8s %8s %6s\n' "$target" "$(stat number_of_executed_units)" "$(stat average_exec_per_sec)" \
    "$(find "$out/$target/corpus" -type f | wc -l)" "$(stat peak_rss_mb)" "$(find "$out/$target/found" -name 'slow-*' | wc -l)"
  if [ "$status" -ne 0 ]; then
    failed=1
    echo "  broken: $(grep -a -m 1 -E '^broken:|runtime error|ERROR: (libFuzzer|[A-Za-z]+Sanitizer)' "$log" || echo "exit code $status"); see $log"
    find "$out/$target/found" -type f -not -name 'slow-*' -printf '  input: %p\n'
  fi
  if $merge && [ "$status" -eq 0 ]; then
    "$program" -merge=1 -max_len=$max_len "tests/fuzz/corpus/$target" "$out/$target/corpus" > "$log.merge" 2>&1
  fi
done
exit $failed
