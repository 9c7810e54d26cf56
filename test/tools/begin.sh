# Sourced by a script that is run as SCRIPT VANTAGE …: $vantage, a folder $work that is gone at the
# end, and `fail WORDS`, which shows $work/out where there is one.
set -euo pipefail
vantage=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "$(basename "$0"): $*" >&2
  [[ ! -s "$work/out" ]] || sed 's/^/  /' "$work/out" >&2
  exit 1
}
