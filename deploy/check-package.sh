#!/usr/bin/env bash
# Installs the packages of deploy/package.sh into a fresh Debian 12 root, runs the demo and the Python module there as an
# ordinary user, builds the example against the library, and takes the packages out again. Needs root, mmdebstrap and a Debian mirror.
# usage: check-package.sh [FOLDER]     FOLDER: of the .deb files, default build/packages; exit code 77: not possible here
set -euo pipefail
packages=$(realpath "${1:-$(dirname "$0")/../build/packages}")
[ "$(id -u)" -eq 0 ] || { echo "skipped: only root can make another root"; exit 77; }
command -v mmdebstrap >/dev/null || { echo "skipped: no mmdebstrap here"; exit 77; }
ls "$packages"/*.deb >/dev/null || { echo "no packages in $packages: deploy/package.sh makes them" >&2; exit 1; }

root=$(mktemp -d)
trap 'umount -l "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
started=$SECONDS
mmdebstrap --variant=apt bookworm "$root"
mount -t proc proc "$root/proc"
mkdir "$root/packages"
cp "$packages"/*.deb "$root/packages"
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive HOME=/root "$@"; }
as_user() { chroot "$root" setpriv --reuid=1000 --regid=1000 --clear-groups env -i PATH=/usr/bin:/bin LC_ALL=C.UTF-8 HOME=/home/user "$@"; }
cp /etc/resolv.conf "$root/etc/resolv.conf"
inside apt-get update -q
inside sh -c 'apt-get install -q -y --no-install-recommends /packages/*.deb'
echo "root and packages: $((SECONDS - started)) s"
inside useradd --create-home --uid 1000 user

as_user depthfarm --version
as_user sh -c 'cd && depthfarm demo -o demo'
as_user depthfarm verify /home/user/demo/result
inside test -e /usr/share/man/man1/depthfarm-run.1.gz
# The daemons' user comes with them where systemd is; its files are there anyway.
inside test -e /usr/lib/systemd/system/depthfarm-worker.service -a -e /etc/default/depthfarm-worker
as_user python3 -c 'import depthfarm; print("Python module", depthfarm.__version__)'
inside apt-get install -q -y --no-install-recommends g++ cmake make
as_user sh -c 'mkdir -p ~/example && cd ~/example && cp /usr/share/doc/libdepthfarm-dev/examples/depth_of_pictures.cc . &&
  printf "%s\n" "cmake_minimum_required(VERSION 3.25)" "project(example CXX)" "set(CMAKE_CXX_STANDARD 17)" \
    "find_package(depthfarm 0.1 REQUIRED)" "add_executable(example depth_of_pictures.cc)" \
    "target_link_libraries(example depthfarm::depthfarm)" >CMakeLists.txt && cmake -B build >/dev/null && cmake --build build'
# Three pictures of noise that is shifted by 4 pixels from each to the next: depth 100 * 0.2 / 4 = 5.
as_user python3 - <<'END'
import numpy as np
rng = np.random.default_rng(1)
noise = np.kron(rng.integers(0, 256, (40, 60, 3)), np.ones((2, 2, 1))).astype(np.uint8)
for i in range(3):
    picture = noise[:, 4 * i:4 * i + 96]
    with open(f"/home/user/example/{i}.ppm", "wb") as file:
        file.write(b"P6\n96 80\n255\n" + picture.tobytes())
END
as_user sh -c 'cd ~/example && build/example 100 0.2 2.5 20 0.ppm 1.ppm 2.ppm'
as_user python3 - <<'END'
import numpy as np
data = open("/home/user/example/cam1.pfm", "rb").read()
z = np.frombuffer(data.split(b"\n", 3)[3], dtype="<f4").reshape(80, 96)
near = np.mean(np.abs(z[10:-10, 12:-12] - 5) < 0.25)
print(f"example: {near:.1%} of the depth is right")
assert near > 0.9
END
inside apt-get purge -q -y depthfarm depthfarm-worker depthfarm-coordinator libdepthfarm-dev libdepthfarm0.1 python3-depthfarm
left=$(inside sh -c 'find /usr /etc /lib -name "*depthfarm*"')
[ -z "$left" ] || { echo "left behind: $left" >&2; exit 1; }
echo "packages: all is well, $((SECONDS - started)) s"
