#!/bin/sh
# LinuxCNC 2.9's own interpreter on three valid programs that one would guess to mean something else. Debian 12, amd64.
#
# 1. F is taken before G20 or G21 of its own block: after G21, "G20 F20" is 20 mm/min, not 20 inch/min.
# 2. A G94 that is in force already forgets the feed: "G94 F10", then "G94 G1 X1" has no feed.
# 3. The tolerance of an arc's centre (0.028 mm) is no limit: up to a thousandth of the radius a hundred times that
#    passes, so that an arc of 10 m ends 2.8 mm off its circle.
#
# Exits 0 while this is so. Needs apt-get and dpkg; nothing is installed outside of a temporary folder.
set -eu
version='2.9.0~pre1+git20230208.f1270d6ed7-1+deb12u2'
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download "linuxcnc-uspace=$version" libboost-python1.74.0 libpython3.11 libedit2 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
for package in *.deb; do dpkg -x "$package" .; done
export LD_LIBRARY_PATH="$folder/usr/lib:$folder/usr/lib/x86_64-linux-gnu" HOME="$folder"
: >empty.tbl
: >empty.var

run() { # the canonical calls of a program, or the control's error
    printf "$1" >program.ngc
    usr/bin/rs274 -g -t empty.tbl -v empty.var program.ngc 2>&1 | sed 's/^ *[0-9]* N[.0-9]* *//'
}

failed=0
expect() { # what a program answers, its text, what is expected somewhere in the answer
    answer=$(run "$2" | tr '\n' ' ')
    case $answer in
        *"$3"*) echo "as before: $1" ;;
        *) echo "CHANGED: $1"; echo "  $answer"; failed=1 ;;
    esac
}

echo "linuxcnc-uspace $version, rs274"
expect "1. F20 is set before the unit of its block" 'G21\nG20 F20\nG1 X1\nM2\n' \
    'SET_FEED_RATE(20.0000) USE_LENGTH_UNITS(CANON_UNITS_INCHES) STRAIGHT_FEED(1.0000,'
expect "2. a second G94 forgets F" 'G94 F10\nG94 G1 X1\nM2\n' 'Cannot do g1 with zero feed rate'
expect "3. an arc that ends 2.8 mm off its circle runs" 'F100 G0 X10000 Y0\nG3 X0 Y10002.8 I-10000 J0\nM2\n' \
    'ARC_FEED(0.0000, 10002.8000, 0.0000, 0.0000, 1,'
exit $failed
