#!/usr/bin/env bash
# LinuxCNC 2.9 (Debian 12, linuxcnc-uspace): a BREAK that is never executed ends another loop.
#
# Expected (docs, O codes): `break` leaves the loop it stands in; a do/while loop runs as long as its condition holds.
# Seen: when the condition of a WHILE loop becomes false, the interpreter skips to its ENDWHILE and takes note of the
# BREAKs of that loop which it passes, executed or not. The note stays, and the next DO loop ends after one round.
# A CONTINUE in a DO loop leaves a note of its own: the next REPEAT runs twice. And REPEAT [2.5] runs 2 rounds,
# REPEAT [3.5] 4 (halves to even), while ROUND[2.5] is 3 (halves away from zero).
set -euo pipefail
version="2.9.0~pre1+git20230208.f1270d6ed7-1+deb12u2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -q "linuxcnc-uspace=$version" libboost-python1.74.0=1.74.0+ds1-21 libpython3.11 libedit2 >/dev/null 2>&1
for package in *.deb; do dpkg -x "$package" .; done
export LD_LIBRARY_PATH="$folder/usr/lib:$folder/usr/lib/x86_64-linux-gnu" HOME="$folder"
echo "T999 P999 Z0 D0" >tools.tbl

positions() { # the X values that a program moves to
    printf '%s\n' "$1" >program.ngc
    usr/bin/rs274 -g -t tools.tbl -v none.var program.ngc 2>/dev/null |
        sed -n 's/.*STRAIGHT_TRAVERSE(\([-0-9.]*\),.*/\1/p' | tr '\n' ' ' || true
}
failed=0
check() { # what is looked at, what the documentation lets one expect, what is seen, the program
    local found
    found=$(positions "$4")
    echo "$1: X $found(expected $2)"
    [ "$found" = "$3" ] || { echo "  CHANGED: it was $3"; failed=1; }
}
echo "linuxcnc-uspace $version"
check "DO loop behind a WHILE loop whose BREAK was never reached" "1 2 3" "1.0000 " '#1=0 #2=0
o1 while [#2 LT 2]
#2=[#2+1]
o2 if [#2 GT 99]
o1 break
o2 endif
o1 endwhile
o3 do
#1=[#1+1]
G0 X#1
o3 while [#1 LT 3]
M2'
check "the same without the BREAK" "1 2 3" "1.0000 2.0000 3.0000 " '#1=0 #2=0
o1 while [#2 LT 2]
#2=[#2+1]
o1 endwhile
o3 do
#1=[#1+1]
G0 X#1
o3 while [#1 LT 3]
M2'
check "REPEAT [2] behind a DO loop with a CONTINUE" "1 2" "1.0000 2.0000 3.0000 4.0000 " '#1=0 #2=0
o1 do
#2=[#2+1]
o1 continue
o1 while [#2 LT 2]
o3 repeat [2]
#1=[#1+1]
G0 X#1
o3 endrepeat
M2'
check "REPEAT [2.5]" "1 2 3" "1.0000 2.0000 " '#1=0
o3 repeat [2.5]
#1=[#1+1]
G0 X#1
o3 endrepeat
M2'
check "ROUND[2.5]" "3" "3.0000 " 'G0 X[ROUND[2.5]]
M2'
exit $failed
