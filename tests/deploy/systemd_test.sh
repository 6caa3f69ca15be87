#!/usr/bin/env bash
# The units of deploy/systemd: what systemd thinks of them, and whether the programs take what they are started with.
# usage: systemd_test.sh SOURCE-FOLDER PROGRAM-FOLDER     exit code 77: systemd's tools are not here
set -euo pipefail
units=$1/deploy/systemd
programs=$2

for tool in systemd-analyze systemd-sysusers systemd-tmpfiles; do
  command -v "$tool" >/dev/null || { echo "skipped: no $tool here"; exit 77; }
done
work=$(mktemp -d)
pids=()
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap finish EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }

# A key that systemd does not know is one line on stderr and no failure: nothing may be said at all.
for unit in depthfarm-coordinator depthfarm-worker; do
  sed "s#/usr/bin/#$programs/#" "$units/$unit.service" >"$work/$unit.service"
  said=$(systemd-analyze verify --man=no "$work/$unit.service" 2>&1) || fail "$unit: $said"
  [ -z "$said" ] || fail "$unit: $said"
  level=$(systemd-analyze security --offline=true --threshold=20 "$work/$unit.service" | tail -n 1) ||
    fail "$unit is exposed more than 2.0: $level"
  echo "$level"
done
# The check can fail: a misspelt key is found.
sed 's/^PrivateTmp=/PrivateTemp=/' "$work/depthfarm-worker.service" >"$work/misspelt.service"
[ -n "$(systemd-analyze verify --man=no "$work/misspelt.service" 2>&1)" ] || fail "a misspelt key is not found"

# Users and folders, in a root of their own.
root=$work/root
mkdir -p "$root/etc"
systemd-sysusers --root="$root" "$units/depthfarm.sysusers"
grep -q '^depthfarm:' "$root/etc/passwd" || fail "no user depthfarm"
if [ "$(id -u)" -eq 0 ]; then
  systemd-tmpfiles --root="$root" --create "$units/depthfarm.tmpfiles"
  [ "$(stat -c %a "$root/etc/depthfarm/keys")" = 700 ] || fail "others may enter the folder of keys"
  owner=$(grep '^depthfarm:' "$root/etc/passwd" | cut -d: -f3)
  [ "$(stat -c %u "$root/etc/depthfarm/keys")" = "$owner" ] || fail "the keys are not the daemons'"
fi

# What a unit starts: its command with its own variables and those of its example file.
command_of() {
  local unit=$1 text
  (
    set -a
    # shellcheck disable=SC1090
    source <(sed -n 's/^Environment=//p' "$units/$unit.service")
    # shellcheck disable=SC1090
    source "$units/$unit.default"
    # shellcheck disable=SC1090
    source "$work/overrides"
    text=$(sed -n 's/^ExecStart=//p' "$units/$unit.service")
    text=${text//\/etc\/depthfarm\/keys/$work/keys}
    eval "echo \"${text/\/usr\/bin/$programs}\""
  )
}
"$programs/depthfarm" keygen -o "$work/keys" >/dev/null
mkdir "$work/state" "$work/cache"
printf '%s\n' 'LISTEN=tcp://127.0.0.1:*' "STATE_DIRECTORY=$work/state" "CACHE_DIRECTORY=$work/cache" >"$work/overrides"
read -r -a coordinator <<<"$(command_of depthfarm-coordinator)"
"${coordinator[@]}" >"$work/coordinator.log" 2>&1 &
pids+=($!)
for _ in $(seq 1 600); do
  grep -q '^listening on ' "$work/coordinator.log" && break
  sleep 0.1
done
endpoint=$(sed -n 's/^listening on //p' "$work/coordinator.log")
[ -n "$endpoint" ] || fail "the coordinator does not start: $(cat "$work/coordinator.log")"
printf 'COORDINATOR=%s\n' "$endpoint" >>"$work/overrides"
read -r -a worker <<<"$(command_of depthfarm-worker)"
"${worker[@]}" >"$work/worker.log" 2>&1 &
pids+=($!)
for _ in $(seq 1 600); do
  grep -q welcomed "$work/worker.log" && break
  sleep 0.1
done
grep -q welcomed "$work/worker.log" || fail "the worker does not join: $(cat "$work/worker.log")"
[ -e "$work/state/coordinator.sqlite" ] || fail "no journal in the state folder"
# `systemctl reload`
kill -HUP "${pids[@]}"
for _ in $(seq 1 600); do
  grep -q keys_reread "$work/worker.log" && break
  sleep 0.1
done
grep -q keys_reread "$work/worker.log" || fail "SIGHUP is not taken: $(cat "$work/worker.log")"
echo "systemd units: all is well"
