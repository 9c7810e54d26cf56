#!/usr/bin/env bash
# version.sh CMAKE SOURCE: checks that the version changes with the content that is built, whether
# committed or not, and with nothing else. Exit code 77: git is missing.
set -euo pipefail
cmake=$1
script=$2/cmake/WriteVersion.cmake
git --version > /dev/null 2>&1 || exit 77
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
repo=$work/repo
mkdir -p "$repo/models" "$repo/docs"
in_repo() { git -C "$repo" -c user.name=a -c user.email=a@b "$@" > /dev/null; }
version() {
  "$cmake" -D SOURCE="$repo" -D VERSION=1.2.3 -D OUTPUT="$work/version.cpp" -P "$script"
  sed -n 's/.*return "\(.*\)".*/\1/p' "$work/version.cpp"
}
expect() { [[ $2 == "$3" ]] || { echo "$1: '$2' is not '$3'"; exit 1; }; }
expect_other() { [[ $2 != "$3" ]] || { echo "$1: still '$2'"; exit 1; }; }

expect "no checkout" "$(version)" 1.2.3
in_repo init -q -b main
echo "int f();" > "$repo/models/f.hpp"
in_repo add .
in_repo commit -m first
first=$(version)
expect "a commit" "$first" "1.2.3+$(git -C "$repo" rev-parse --short HEAD)"
echo "words" > "$repo/docs/page.md"
expect "a page" "$(version)" "$first"
in_repo add .
in_repo commit -m words
expect "a page's commit" "$(version)" "$first"
echo "double f();" > "$repo/models/f.hpp"
changed=$(version)
expect "a change" "${changed%.changed-*}" "$first"
expect_other "a change" "$changed" "$first"
expect "the same change" "$(version)" "$changed"
echo "float f();" > "$repo/models/f.hpp"
expect_other "another change" "$(version)" "$changed"
in_repo checkout -- models/f.hpp
expect "the change taken back" "$(version)" "$first"
echo "int g();" > "$repo/models/g.hpp"
added=$(version)
expect_other "a new file" "$added" "$first"
echo "double g();" > "$repo/models/g.hpp"
expect_other "a change of it" "$(version)" "$added"
in_repo add .
in_repo commit -m second
expect "a second commit" "$(version)" "1.2.3+$(git -C "$repo" rev-parse --short HEAD)"
written=$(stat -c %y "$work/version.cpp")
version > /dev/null
expect "nothing new" "$(stat -c %y "$work/version.cpp")" "$written"
echo "the version follows what is built"
