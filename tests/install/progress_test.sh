#!/bin/sh
# progress_test.sh SCRIPT: the progress of a build is one renewed line on a terminal, a line every 10 % elsewhere, and all that
# ninja wrote is in the log.
set -eu
script=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
  echo "$1" >&2
  exit 1
}

{
  echo "-- Configuring done"
  i=0
  while [ "$i" -lt 40 ]; do
    i=$((i + 1))
    echo "[$i/40] Building CXX object part_$i.cpp.o"
  done
  echo "[what/ever] is no step"
  echo "[41/40] nor is this"
  printf 'warning: without an end'
} >"$folder/ninja"

echo "before" >"$folder/log"
"$script" "$folder/log" building <"$folder/ninja" 2>"$folder/shown"
[ "$(wc -l <"$folder/shown")" = 11 ] || fail "not a line every 10 %: $(cat "$folder/shown")"
[ "$(sed -n 3p "$folder/shown")" = "building: 20 %" ] || fail "third line: $(sed -n 3p "$folder/shown")"
[ "$(tail -n 1 "$folder/shown")" = "building: 100 %" ] || fail "last line: $(tail -n 1 "$folder/shown")"
{ echo "before"; cat "$folder/ninja"; echo; } | cmp - "$folder/log" || fail "the log is not what ninja wrote"

UMTET_PROGRESS_TERMINAL=1 "$script" "$folder/log" building <"$folder/ninja" 2>"$folder/shown"
[ "$(wc -l <"$folder/shown")" = 1 ] || fail "on a terminal it is more than one line"
[ "$(tr -cd '\r' <"$folder/shown" | wc -c)" = 41 ] || fail "the line is not renewed by every step"

echo "no step at all" | "$script" "$folder/log" building 2>"$folder/shown"
[ "$(cat "$folder/shown")" = "building: 0 %" ] || fail "progress of nothing: $(cat "$folder/shown")"
