#!/bin/bash
# systemd_unit.sh UNIT VANTAGE: checks that systemd accepts the example unit. Exit code 77:
# systemd-analyze is missing.
set -euo pipefail
command -v systemd-analyze > /dev/null || { echo "skipped: no systemd-analyze"; exit 77; }
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
# The unit's program and user need not be installed on this machine.
sed -e "s,/usr/local/bin/vantage,$2," -e 's/^User=.*/User=root/' "$1" > "$dir/vantage.service"
words=$(systemd-analyze verify --recursive-errors=no "$dir/vantage.service" 2>&1) || {
  echo "$words"
  exit 1
}
# Fails on unknown keys, of which systemd-analyze only warns.
if grep -F vantage.service <<< "$words"; then
  exit 1
fi
