#!/usr/bin/env bash
# completion.sh COMPLETION VANTAGE: checks the words that bash completion offers.
set -euo pipefail
source "$1"
offered() {  # offered WORD…: prints the completions that are offered for WORD…; the last WORD may be incomplete
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  COMPREPLY=()
  _vantage
  echo "${COMPREPLY[*]}"
}
expect() { [[ "$1" == "$2" ]] || { echo "offered '$1' instead of '$2'"; exit 1; }; }
expect "$(offered "$2" tri)" trial
expect "$(offered "$2" log met)" metrics
expect "$(offered "$2" log fit)" "fit-motion fit-ranges fit-sensor"
expect "$(offered "$2" log fit-ranges ranges.csv --po)" --poses
expect "$(offered "$2" log imp)" import
expect "$(offered "$2" log import mrclam --fo)" --force
expect "$(offered "$2" log localize six.lcmlog --late)" --late-s
expect "$(offered "$2" log fit-motion --fitted)" --fitted-share
expect "$(offered "$2" log fit-motion flight.lcmlog --fitted)" --fitted-share
expect "$(offered "$2" keys rotate keys --si)" --sign
expect "$(offered "$2" experiment dls-savings --smo)" --smoke
expect "$(offered "$2" trial config/lab.yaml --duration)" --duration-s
expect "$(offered "$2" trial fli)" ""

# On every level, the offered words must be exactly those that --help lists.
listed() { "$@" --help | awk '/^$/ {on = 0} on {print $1} /^Subcommands:/ {on = 1}' | sort -u | xargs; }
every_level() {  # every_level VANTAGE WORD…
  local name names
  names=$(listed "$@")
  [[ -z "$names" ]] && return
  expect "$(offered "$@" "" | tr ' ' '\n' | grep -v '^--' | xargs)" "$names"
  levels=$((levels + 1))
  for name in $names; do
    every_level "$@" "$name"
  done
}
levels=0
every_level "$2"
((levels >= 4)) || { echo "only $levels levels were seen: vantage, config, keys, log"; exit 1; }
