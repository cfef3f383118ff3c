# completions.bash FILE: what is offered after some words.
set -eu
source "$1"

offered() {
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  _umtet
  echo "${COMPREPLY[*]}"
}
expect() {
  local wanted=$1 got
  shift
  got=$(offered "$@")
  [[ " $got " == *" $wanted "* ]] || { echo "after '$*' there is no $wanted in: $got" >&2; exit 1; }
}

expect mesh umtet ''
expect evolve umtet ev
expect --background umtet mesh -
expect --max-deviation umtet mesh --max
expect --keep-all umtet run --keep
expect paper umtet mesh --mode ''
expect plain umtet run --progress p
[[ -z $(offered umtet mesh --h '') ]] || { echo "--h takes a number" >&2; exit 1; }
[[ -z $(offered umtet run duck) ]] || { echo "a file is left to the shell" >&2; exit 1; }
