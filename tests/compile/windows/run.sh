#!/bin/sh
# run.sh FOLDER WINE COMPILER FLAG ...: FOLDER/main.cpp as a Windows program, run by Wine in that folder, where it leaves walk.bvh.
set -e
cd "$1"
wine=$2
shift 2
rm -f walk.bvh
"$@" -O1 -Wa,-muse-unaligned-vector-move -static main.cpp -o main.exe
WINEDEBUG=-all WINEPREFIX=$PWD/wine "$wine" main.exe
test -s walk.bvh
