#!/bin/sh
# same_bits.sh PROGRAM PROGRAM MODEL: both print the same, with the kernels of every processor and with the best of
# this one.
set -eu
for kernels in portable ""; do
  first=$(MOTIONLANG_KERNELS=$kernels "$1" "$3")
  second=$(MOTIONLANG_KERNELS=$kernels "$2" "$3")
  printf 'kernels: %s\n%s\n%s\n' "${kernels:-best}" "$first" "$second"
  test -n "$first"
  test "$first" = "$second"
done
