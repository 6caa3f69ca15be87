#!/usr/bin/env bash
# A small Debian 12 to begin images with, as debian:12-slim is one, where no registry is in reach. Needs root.
# usage: bootstrap.sh FILE.tar
set -euo pipefail
# Lists of packages are of no use in an image, and what a later layer removes still takes its room.
# shellcheck disable=SC2016
mmdebstrap --variant=apt --dpkgopt="$(dirname "$(realpath "$0")")/dpkg.cfg" --customize-hook='rm -r "$1"/var/lib/apt/lists' \
  bookworm "${1:?usage: bootstrap.sh FILE.tar}"
