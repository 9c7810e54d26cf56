#!/bin/bash
# setup_once.sh SOURCE_DIR: checks that `tools/setup --once` reports what is missing. If npm has failed,
# `tools/setup --once` calls npm again only after the package files have changed; `tools/setup` always does.
# Runs on a copy. In place of npm, a script fails each time; in place of dpkg-query, a script reports
# every package as installed.
set -euo pipefail
source=$1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

mkdir -p "$dir/bin" "$dir/tools"
cp "$source/tools/setup" "$dir/tools"
folders=(test/wire/mavlink/peer test/logs/mcap_peer test/view/peer tools/view/page)
for folder in "${folders[@]}"; do
  mkdir -p "$dir/$folder"
  cp "$source/$folder"/package*.json "$dir/$folder"
done
printf '#!/bin/sh\necho installed\n' > "$dir/bin/dpkg-query"
printf '#!/bin/sh\nexit 1\n' > "$dir/bin/apt-get"
printf '#!/bin/sh\necho "$*" >> "%s"\nexit 1\n' "$dir/asked" > "$dir/bin/npm"
chmod +x "$dir"/bin/*

# asks COUNT ARGUMENT…: expects that setup with these arguments calls npm COUNT times and reports what is
# missing.
asks() {
  local count=$1 said
  shift
  : > "$dir/asked"
  said=$(PATH="$dir/bin:$PATH" "$dir/tools/setup" "$@")
  if [[ $(wc -l < "$dir/asked") != "$count" || $(grep -c 'npm could not fetch' <<< "$said") != 4 ]]; then
    printf 'setup %s: not %s times of 4:\n%s\n%s\n' "$*" "$count" "$(< "$dir/asked")" "$said" >&2
    exit 1
  fi
}
asks 4 --once
asks 0 --once
asks 4
asks 0 --once
touch -d '1 minute' "$dir/test/view/peer/package-lock.json" # changed since the last call
asks 1 --once
touch -d '-1 minute' "$dir/test/view/peer/package-lock.json"
for folder in "${folders[@]}"; do # npm has fetched all packages
  touch "$dir/$folder/node_modules/.package-lock.json"
done
[[ -z $(PATH="$dir/bin:$PATH" "$dir/tools/setup" --once) ]]
