#!/usr/bin/env bash
# Builds the container images of what is committed, with podman or buildah: depthfarm-coordinator, depthfarm-worker and
# depthfarm (the command line with both).
# usage: build.sh [--packages DIR] [--base IMAGE | --bootstrap] [--tag TAG]
#   --packages DIR  the .deb files of deploy/package.sh, instead of building them in a container
#   --base IMAGE    what the images begin with (default: debian:12-slim)
#   --bootstrap     begin with a Debian that mmdebstrap makes here, where no registry is in reach; needs root
#   --tag TAG       default: the version
# The builders' own variables hold, e.g. BUILDAH_ISOLATION=chroot and STORAGE_DRIVER=vfs inside of another container.
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
tag=$(sed -n 's/^project(depthfarm VERSION \([0-9.]*\) .*/\1/p' "$source_dir/CMakeLists.txt")
base=debian:12-slim
packages=
bootstrap=
usage() {
  sed -n 's/^# \(usage: .*\)/\1/p' "${BASH_SOURCE[0]}" >&2
  exit 2
}
while [ $# -gt 0 ]; do
  case $1 in
    --packages) packages=$(realpath "${2:?--packages needs a folder}"); shift ;;
    --base) base=${2:?--base needs an image}; shift ;;
    --bootstrap) bootstrap=yes ;;
    --tag) tag=${2:?--tag needs a tag}; shift ;;
    *) usage ;;
  esac
  shift
done
if command -v buildah >/dev/null; then
  build=(buildah build)
elif command -v podman >/dev/null; then
  build=(podman build)
else
  echo "build.sh: neither buildah nor podman is here" >&2
  exit 1
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ -n "$bootstrap" ]; then
  base=localhost/depthfarm-base:bookworm
  "$source_dir/deploy/container/bootstrap.sh" "$work/base.tar"
  if [ "${build[0]}" = podman ]; then
    podman import "$work/base.tar" "$base"
  else
    container=$(buildah from scratch)
    buildah add --quiet "$container" "$work/base.tar" /
    buildah commit --quiet --rm "$container" "$base"
  fi
fi
# With --layers what was built before is there.
build+=(--layers --file "$source_dir/deploy/container/Containerfile" --build-arg "BASE=$base")

if [ -z "$packages" ]; then
  mkdir "$work/sources"
  git -C "$source_dir" archive HEAD | tar -x -C "$work/sources"
  packages=$work/packages
  "${build[@]}" --target packages --output "$packages" "$work/sources"
fi
ls "$packages"/depthfarm_*.deb >/dev/null || { echo "build.sh: no packages in $packages: deploy/package.sh makes them" >&2; exit 1; }
context=$work/context
mkdir -p "$context/build/packages" "$context/deploy"
cp "$packages"/*.deb "$context/build/packages"
cp -r "$source_dir/deploy/container" "$context/deploy"
sources=$(cd "$context" && find . -type f -print0 | sort -z | xargs -0 sha256sum | sha256sum | cut -d ' ' -f 1)
for target in coordinator worker depthfarm; do
  image=depthfarm-$target:$tag
  "${build[@]}" --build-arg "SOURCES=$sources" --target "$target" --tag "${image/depthfarm-depthfarm/depthfarm}" "$context"
done
