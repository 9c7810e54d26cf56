#!/usr/bin/env bash
# completion.sh COMPLETION VANTAGE: what bash offers after some words.
set -euo pipefail
source "$1"
offered() {  # offered WORD…: the last is being typed
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  COMPREPLY=()
  _vantage
  echo "${COMPREPLY[*]}"
}
expect() { [[ "$1" == "$2" ]] || { echo "offered '$1' instead of '$2'"; exit 1; }; }
expect "$(offered "$2" tri)" trial
expect "$(offered "$2" log met)" metrics
expect "$(offered "$2" trial config/lab.yaml --duration)" --duration-s
expect "$(offered "$2" trial fli)" ""
