#!/bin/sh
# What the last stages of the Containerfile do: one package of build/packages with what it depends on, its user and its
# folders, in the root that this runs in.
# usage: install.sh depthfarm|depthfarm-worker|depthfarm-coordinator
set -eu
package=$1
here=$(cd "$(dirname "$0")" && pwd)
packages=$here/../../build/packages

# A number that does not change from image to image: volumes belong to it.
user=10001
groupadd --gid $user depthfarm
useradd --uid $user --gid $user --home-dir /var/lib/depthfarm --no-create-home --shell /usr/sbin/nologin depthfarm
cp "$here/dpkg.cfg" /etc/dpkg/dpkg.cfg.d/depthfarm

# The command line depends on both daemons, of exactly its version.
case $package in
  depthfarm) set -- "$packages"/depthfarm_*.deb "$packages"/depthfarm-worker_*.deb "$packages"/depthfarm-coordinator_*.deb ;;
  *) set -- "$packages/$package"_*.deb ;;
esac
export DEBIAN_FRONTEND=noninteractive
apt-get update -q
apt-get install -q -y --no-install-recommends "$@"
# What dpkg.cfg leaves out must be nothing that a program is linked to.
for program in /usr/bin/depthfarm*; do
  if ldd "$program" | grep 'not found'; then
    echo "install.sh: $program lacks a library" >&2
    exit 1
  fi
done
apt-get clean
rm -rf /var/lib/apt/lists/* /var/cache/debconf/*-old /var/log/apt /var/log/dpkg.log

# Where volumes go; without one, `podman run --volume` and tests find a folder that is theirs.
for folder in /run/depthfarm /var/lib/depthfarm /var/cache/depthfarm /srv/depthfarm; do
  install -d -o $user -g $user "$folder"
done
