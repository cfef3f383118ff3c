#!/bin/sh
# progress.sh LOG WHAT: what ninja writes, on stdin, goes to LOG; on stderr stands how much of it is done, in percent, and how
# long the rest takes. On a terminal that is one line, which is renewed; elsewhere a line every 10 %.
set -eu
log=$1
what=$2
exec 3>>"$log"
started=$(date +%s)
next=0  # percent that are worth a line
shown=
n=0
all=1
if [ -t 2 ] || [ -n "${UMTET_PROGRESS_TERMINAL:-}" ]; then renews=1; else renews=; fi

show() {
  left=
  seconds=$(($(date +%s) - started))
  if [ "$1" -lt 100 ] && [ "$n" -gt 0 ] && [ "$seconds" -gt 4 ]; then
    rest=$((seconds * (all - n) / n))
    left=", about $((rest / 60)) min $((rest % 60)) s left"
  fi
  if [ -n "$renews" ]; then
    printf '\r%s: %3d %%%s\033[K' "$what" "$1" "$left" >&2
  else
    printf '%s: %d %%%s\n' "$what" "$1" "$left" >&2
  fi
  shown=1
}

while IFS= read -r line || [ -n "$line" ]; do
  printf '%s\n' "$line" >&3
  if [ -z "$shown" ]; then
    show 0
    next=10
  fi
  case $line in
    \[[0-9]*/[0-9]*\]*) step=${line#\[} ;;
    *) continue ;;
  esac
  step=${step%%\]*}
  n=${step%/*}
  all=${step#*/}
  case $n$all in *[!0-9]*) continue ;; esac
  [ "$all" -gt 0 ] && [ "$n" -le "$all" ] || continue
  percent=$((100 * n / all))
  if [ -n "$renews" ]; then
    show "$percent"
  elif [ "$percent" -ge "$next" ]; then
    show "$percent"
    next=$((percent / 10 * 10 + 10))
  fi
done
[ -z "$renews" ] || [ -z "$shown" ] || printf '\n' >&2
