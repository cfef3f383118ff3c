#!/bin/sh
# run_script.sh PROGRAM SCRIPT: every subcommand of the program reaches it through ./run, and a path is a cloud for `umtet run`.
set -eu
program=$1
script=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/build/release/pipeline"
cp "$script" "$folder/run"
printf '#!/bin/sh\n' >"$folder/setup"
printf '#!/bin/sh\necho "$*"\n' >"$folder/build/release/pipeline/umtet"
chmod +x "$folder/setup" "$folder/build/release/pipeline/umtet"

expect() {
  wanted=$1
  shift
  got=$("$folder/run" "$@")
  [ "$got" = "$wanted" ] || { echo "./run $*: umtet was called with '$got', not '$wanted'" >&2; exit 1; }
}

subcommands=$("$program" --help | sed -n '/^S[Uu][Bb][Cc][Oo][Mm][Mm][Aa][Nn][Dd][Ss]:/,$p' | sed -n 's/^  \([a-z][a-z]*\) .*/\1/p')
[ "$(echo "$subcommands" | wc -w)" -ge 10 ] || { echo "the help of $program lists too few subcommands" >&2; exit 1; }
for subcommand in $subcommands; do
  expect "$subcommand -o case" "$subcommand" -o case
done
expect "run clouds/duck.ply -o duck" clouds/duck.ply -o duck
expect "run scan_2.xyz" scan_2.xyz
expect "--version" --version
