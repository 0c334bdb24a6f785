#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The Debian package: built by CPack, installed by apt on top of this machine (in an overlay that no other process sees), used from there, and
# purged.
#   deb_test.sh BUILD_DIR        exits 77 (skipped) without root, without overlay mounts, and with another LCM than Debian's
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
fail() { echo "FAILED: $*"; exit 1; }

if [[ "${1:-}" != --inside ]]; then
  [[ "$(id -u)" -eq 0 ]] || { echo "skipped: to install a package takes root"; exit 77; }
  generator=$(sed -n 's/^NODMAP_LCM_GEN:FILEPATH=//p' "$1/CMakeCache.txt")
  dpkg -S "$generator" >/dev/null 2>&1 || { echo "skipped: a package for Debian takes Debian's LCM, and this build has that of $generator"; exit 77; }
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  mkdir "$work/upper" "$work/work" "$work/root" "$work/package"
  overlay=lowerdir=/,upperdir=$work/upper,workdir=$work/work
  unshare -m mount -t overlay overlay -o "$overlay" "$work/root" 2>/dev/null || { echo "skipped: no overlay here"; exit 77; }
  cpack --config "$1/CPackConfig.cmake" -B "$work/package" >"$work/log" 2>&1 || { cat "$work/log"; fail "cpack"; }
  cp "$work"/package/*.deb "$work/upper/nodmap.deb"
  cp -r "$here" "$work/upper/packaging"
  # Also in a network namespace of its own: the deputy must not send messages to others.
  unshare -m -n bash -c '
    set -e
    mount -t overlay overlay -o "$1" "$2"
    for folder in proc dev sys; do mount --rbind "/$folder" "$2/$folder"; done
    ip link set lo up
    ip route add 224.0.0.0/4 dev lo
    exec chroot "$2" /packaging/deb_test.sh --inside' bash "$overlay" "$work/root"
  exit
fi

# From here on everything happens in the overlay.
cd /
unset LCM_DEFAULT_URL
dpkg-deb --field nodmap.deb Package Version Architecture Depends Recommends
# Packages that no program is linked to but that the build machine has: the page consists of them.
for package in libjs-three libjs-dygraphs; do
  dpkg-deb --field nodmap.deb Depends | grep -qw "$package" || fail "the package does not depend on $package"
done
before=$(find /etc /usr /var /opt -name '*nodmap*' -not -path '/var/cache/man/*' | sort)
DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends /nodmap.deb >log 2>&1 || { cat log; fail "apt"; }

mapfile -t programs < <(dpkg -L nodmap | grep '^/usr/bin/')
[[ ${#programs[@]} -ge 15 ]] || fail "only ${#programs[@]} programs"
for program in "${programs[@]}"; do
  "$program" --version >log 2>&1 || { cat log; fail "$program does not run"; }
done
for program in "${programs[@]}"; do
  [[ -s /usr/share/man/man1/${program##*/}.1.gz ]] || fail "no man page of $program"
  [[ -s /usr/share/bash-completion/completions/${program##*/} ]] || fail "no completion of $program"
done
if command -v lintian >/dev/null; then
  lintian --fail-on error,warning nodmap.deb >log 2>&1 || { cat log; fail "lintian"; }
fi
for config in /usr/share/nodmap/procman/*.pmd; do nodmap-sheriff "$config" --check | head -n 1; done

if command -v systemd-analyze >/dev/null; then
  systemd-analyze verify /lib/systemd/system/nodmap-deputy.service /lib/systemd/system/nodmap-robot.service >log 2>&1 ||
    { cat log; fail "a unit"; }
  grep nodmap log && fail "a unit"
fi
# Starts what the unit starts, with the account, environment and command of its lines.
set -a
source /etc/nodmap/deputy.conf
set +a
setpriv --reuid nodmap --regid nodmap --init-groups nodmap-deputy "$NODMAP_CONFIG" --id "$NODMAP_DEPUTY_ID" >deputy.log 2>&1 &
deputy=$!
trap 'kill -TERM "$deputy" 2>/dev/null || true; wait' EXIT  # also when the test fails
while ! grep -q serving deputy.log && kill -0 "$deputy" 2>/dev/null; do sleep 0.1; done
nodmap-sheriff "$NODMAP_CONFIG" --status >log || { cat log deputy.log; fail "the deputy does not answer"; }
# The same for the boot service.
setpriv --reuid nodmap --regid nodmap --init-groups nodmap-sheriff "$NODMAP_CONFIG" --script "$NODMAP_STOP_SCRIPT" --on-script-complete exit \
  --timeout 300 >log 2>&1 || { cat log; fail "the sheriff's script"; }
kill -TERM "$deputy"
wait "$deputy" || { cat deputy.log; fail "the deputy does not end well"; }
trap - EXIT

cmake -S packaging/consumer -B consumer >log 2>&1 || { cat log; fail "find_package(nodmap)"; }
cmake --build consumer >log 2>&1 || { cat log; fail "another project does not build"; }
consumer/consumer
lcm-gen -p --ppath python /usr/share/lcmtypes/nodmap_*.lcm || fail "the types in share/lcmtypes"
jar=/usr/share/java/lcmtypes_nodmap.jar
if [[ -e $jar ]]; then
  python3 -m zipfile -l $jar >log
  grep -q 'nodmap/scan_t.class' log || fail "the jar holds no types"
  { nodmap-doctor || true; } >log
  grep -q 'types jar: lcmtypes_nodmap.jar is there' log || { cat log; fail "nodmap-doctor does not find the jar"; }
  echo "$jar: $(grep -c '_t\.class' log) types"
else
  echo "no types for lcm-spy in this build: it had no Java"
fi

# An upgrade names the processes that still run the old programs.
/var/lib/dpkg/info/nodmap.postinst configure 0.0.9 | grep -q "systemctl restart nodmap-deputy" || fail "an upgrade says nothing"

DEBIAN_FRONTEND=noninteractive apt-get purge -y nodmap >log 2>&1 || { cat log; fail "purge"; }
after=$(find /etc /usr /var /opt -name '*nodmap*' -not -path '/var/cache/man/*' | sort)  # man caches pages that were read
[[ "$before" == "$after" ]] || fail "left after the purge: $(comm -13 <(echo "$before") <(echo "$after"))"
echo "${#programs[@]} programs installed, used and purged"
