#!/bin/bash
# systemd_unit.sh UNIT VANTAGE: systemd accepts the example unit. Exit code 77: systemd-analyze is missing.
set -euo pipefail
command -v systemd-analyze > /dev/null || { echo "skipped: no systemd-analyze"; exit 77; }
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
# Its program and user need not be installed here.
sed -e "s,/usr/local/bin/vantage,$2," -e 's/^User=.*/User=root/' "$1" > "$dir/vantage.service"
words=$(systemd-analyze verify --recursive-errors=no "$dir/vantage.service" 2>&1) || {
  echo "$words"
  exit 1
}
# systemd-analyze only warns of keys that it does not know.
if grep -F vantage.service <<< "$words"; then
  exit 1
fi
