# Sourced by scripts that are run as SCRIPT VANTAGE …. Sets $vantage and $work, a folder that is removed at
# the end. Defines `fail WORDS`, which also shows $work/out if it exists.
set -euo pipefail
vantage=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "$(basename "$0"): $*" >&2
  [[ ! -s "$work/out" ]] || sed 's/^/  /' "$work/out" >&2
  exit 1
}
