#!/usr/bin/env bash
# Whether the images' programs work as a pod has them: as user 10001, without privileges, on a root that is read-only. Without
# --images it needs no builder of containers: it makes a Debian with mmdebstrap for each image and runs there what the
# Containerfile runs. Needs root, and a Debian mirror.
# usage: check.sh [--packages DIR]    DIR: .deb files of deploy/package.sh, default build/packages; exit code 77: not possible here
#        check.sh --images [TAG]      images that buildah or podman has, of deploy/container/build.sh
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
packages=$source_dir/build/packages
tag=
case ${1:-} in
  --images) tag=${2:-$(sed -n 's/^project(depthfarm VERSION \([0-9.]*\) .*/\1/p' "$source_dir/CMakeLists.txt")} ;;
  --packages) packages=$(realpath "${2:?--packages needs a folder}") ;;
  "") ;;
  *) sed -n 's/^# \(usage: .*\)/\1/p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
esac
[ "$(id -u)" -eq 0 ] || { echo "skipped: only root can make another root"; exit 77; }
user=10001
fail() { echo "FAILED: $*" >&2; exit 1; }

work=$(mktemp -d)
pids=()
containers=()
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait
  for container in "${containers[@]}"; do buildah rm "$container" >/dev/null; done
  for root in "$work"/*/src; do umount "$root" 2>/dev/null || true; done
  rm -rf --one-file-system "$work"
}
trap finish EXIT

# Roots of the three images, $work/<target>.
of_containerfile() {  # TARGET: what its stage runs
  sed -n "/ AS $1\$/,/^FROM/s/^RUN --mount=[^ ]* //p" "$source_dir/deploy/container/Containerfile"
}
if [ -n "$tag" ]; then
  command -v buildah >/dev/null || { echo "skipped: no buildah here"; exit 77; }
  for target in coordinator worker depthfarm; do
    image=depthfarm-$target:$tag
    containers+=("$(buildah from --pull-never "localhost/${image/depthfarm-depthfarm/depthfarm}")")
    [ "$(buildah inspect --format '{{.OCIv1.Config.User}}' "${containers[-1]}")" = $user:$user ] ||
      fail "the image of $target does not run as user $user"
    ln -s "$(buildah mount "${containers[-1]}")" "$work/$target"
  done
else
  command -v mmdebstrap >/dev/null || { echo "skipped: no mmdebstrap here"; exit 77; }
  ls "$packages"/depthfarm_*.deb >/dev/null || fail "no packages in $packages: deploy/package.sh makes them"
  mkdir -p "$work/sources/build"
  cp -r "$source_dir/deploy" "$work/sources"
  cp -r "$packages" "$work/sources/build/packages"
  "$source_dir/deploy/container/bootstrap.sh" "$work/base.tar"
  for target in coordinator worker depthfarm; do
    mkdir "$work/$target"
    tar -x -C "$work/$target" -f "$work/base.tar"
    mkdir "$work/$target/src"
    mount --bind "$work/sources" "$work/$target/src"
    cp /etc/resolv.conf "$work/$target/etc/resolv.conf"
    commands=$(of_containerfile "$target")
    [ -n "$commands" ] || fail "the Containerfile has no stage $target"
    chroot "$work/$target" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 sh -euc "$commands"
    umount "$work/$target/src"
    rmdir "$work/$target/src"
  done
fi

# inside TARGET VOLUMES COMMAND...: as a pod of this image has it; VOLUMES are HERE:THERE, and tmp for a /tmp in memory. The
# process stays the one that is started, so that a signal reaches it.
inside() {
  local root
  root=$(realpath "$work/$1")
  # shellcheck disable=SC2016
  exec unshare --mount --propagation private sh -euc '
    root=$1 volumes=$2 user=$3
    shift 3
    mount --bind "$root" "$root"
    for volume in $volumes; do
      if [ "$volume" = tmp ]; then
        mount -t tmpfs tmpfs "$root/tmp"
      else
        mount --bind "${volume%%:*}" "$root${volume#*:}"
      fi
    done
    mount --rbind /proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount -o remount,bind,ro "$root"
    exec chroot "$root" setpriv --reuid="$user" --regid="$user" --clear-groups --bounding-set=-all --inh-caps=-all --no-new-privs \
      env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"' inside "$root" "$2" $user "${@:3}"
}
for folder in keys coordinator-keys worker-keys client-keys journal cache projects; do
  mkdir "$work/$folder"
  chown $user:$user "$work/$folder"
done

for target in coordinator worker depthfarm; do
  program=depthfarm-$target
  version=$(inside "$target" "" "${program/depthfarm-depthfarm/depthfarm}" --version)
  (inside "$target" "" touch /usr/here 2>/dev/null) && fail "$target may write to its root"
  (inside "$target" "" touch /var/lib/depthfarm/here 2>/dev/null) && fail "$target may write to its root"
  echo "$target: $version, $(du -sm --apparent-size "$(realpath "$work/$target")" | cut -f1) MB," \
    "$(tar -c -C "$(realpath "$work/$target")" . | gzip -1 | wc -c | awk '{printf "%.0f", $1 / 1e6}') MB compressed"
done

# A farm: each program in the root of its own image.
run() { (inside "$@"); }
run depthfarm "$work/keys:/run/depthfarm" depthfarm keygen -o /run/depthfarm/keys >/dev/null
for secret in "coordinator coordinator.pub" "worker worker.pub coordinator.pub" "client client.pub coordinator.pub"; do
  read -r -a files <<<"$secret"
  for file in "${files[0]}.key" "${files[@]:1}" authorized; do cp -p "$work/keys/keys/$file" "$work/${files[0]}-keys"; done
done
# wait_for FILE PATTERN: what follows the pattern in a line of the file
wait_for() {
  for _ in $(seq 1 600); do
    if grep -q "$2" "$1"; then
      sed -n "s/^.*$2//p" "$1" | head -n 1
      return
    fi
    sleep 0.1
  done
  fail "no '$2': $(cat "$1")"
}
inside coordinator "$work/coordinator-keys:/run/depthfarm $work/journal:/var/lib/depthfarm" depthfarm-coordinator \
  --listen='tcp://127.0.0.1:*' --keys=/run/depthfarm --journal=/var/lib/depthfarm/coordinator.sqlite \
  --metrics='127.0.0.1:*' >"$work/coordinator.log" 2>&1 &
pids+=($!)
endpoint=$(wait_for "$work/coordinator.log" 'listening on ')
inside worker "$work/worker-keys:/run/depthfarm $work/cache:/var/cache/depthfarm $work/projects:/srv/depthfarm" depthfarm-worker \
  --coordinator="$endpoint" --keys=/run/depthfarm --cache-dir=/var/cache/depthfarm --cache-size=1GB --stop-grace=5 \
  >"$work/worker.log" 2>&1 &
pids+=($!)
wait_for "$work/worker.log" welcomed >/dev/null
run depthfarm "$work/projects:/srv/depthfarm" depthfarm scene arc -o /srv/depthfarm/scene --cameras 3 --size 160x120 >/dev/null
run depthfarm "$work/client-keys:/run/depthfarm $work/projects:/srv/depthfarm" depthfarm submit /srv/depthfarm/scene/sequence.json \
  -o /srv/depthfarm/depth --wait --coordinator="$endpoint" --keys=/run/depthfarm
run depthfarm "$work/projects:/srv/depthfarm" depthfarm verify /srv/depthfarm/depth
for pid in "${pids[@]}"; do
  kill "$pid"
  wait "$pid" || fail "a daemon ends with $?: $(tail -n 3 "$work"/*.log)"
done
pids=()

# Local runs want a /tmp for their socket; nothing else.
run depthfarm "$work/projects:/srv/depthfarm tmp" sh -c 'HOME=/srv/depthfarm depthfarm demo -o /srv/depthfarm/demo'
run depthfarm "$work/projects:/srv/depthfarm" depthfarm verify /srv/depthfarm/demo/result
echo "containers: all is well, $SECONDS s"
