#!/usr/bin/env bash
# LinuxCNC 2.9 (Debian 12, linuxcnc-uspace): F beside G20 counts in the unit that held before.
#
# Expected: `G20 F20` sets 20 inch/min, as the line says.
# Seen: within a block the feed is set before the unit, so a control that starts in millimetres sets 20 mm/min and then
# converts it: the same physical feed goes on in inches. With F in the next block it is 20 inch/min.
set -euo pipefail
version="2.9.0~pre1+git20230208.f1270d6ed7-1+deb12u2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -q "linuxcnc-uspace=$version" libboost-python1.74.0=1.74.0+ds1-21 libpython3.11 libedit2 >/dev/null 2>&1
for package in *.deb; do dpkg -x "$package" .; done
export LD_LIBRARY_PATH="$folder/usr/lib:$folder/usr/lib/x86_64-linux-gnu" HOME="$folder"
echo "T999 P999 Z0 D0" >tools.tbl

calls() { # the canonical calls that set feed and unit, in their order
    printf 'G21\n%s\nM2\n' "$1" >program.ngc
    usr/bin/rs274 -g -t tools.tbl -v none.var program.ngc 2>/dev/null |
        sed '/SET_XY_ROTATION/,/ON_RESET/d;/SET_FEED_MODE/,$d' |
        sed -n 's/.*\(SET_FEED_RATE([-0-9.]*)\)/\1/p;s/.*\(USE_LENGTH_UNITS(CANON_UNITS_INCHES)\)/\1/p' | tr '\n' ' ' || true
}
failed=0
check() {
    local found
    found=$(calls "$2")
    echo "$1: $found"
    [ "$found" = "$3" ] || { echo "  CHANGED: it was $3"; failed=1; }
}
echo "linuxcnc-uspace $version"
check "G20 F20 in one block   " "G20 F20" "SET_FEED_RATE(20.0000) USE_LENGTH_UNITS(CANON_UNITS_INCHES) "
check "G20, then F20 in a block" $'G20\nF20' "USE_LENGTH_UNITS(CANON_UNITS_INCHES) SET_FEED_RATE(20.0000) "
exit $failed
