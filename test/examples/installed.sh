#!/usr/bin/env bash
# installed.sh CMAKE BUILD SOURCE: checks that other projects can use the files that BUILD installs.
# - with only Eigen and a compiler: the examples of planner and estimator build and run, and no
# other
#    package is searched for, included or linked;  - with any compiler flags they print the same to
# the last digit, and every type of the public headers
#    has the same layout;  - the examples of earlier versions build unchanged (test/data/releases);
# - examples of bus and logs build with the packages that these components need; a missing component
# is
#    named.
set -euo pipefail
cmake=$1 build=$2 source=$3
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix="$work/prefix"
fail() { echo "FAILED: $*" >&2; exit 1; }

"$cmake" --install "$build" --prefix "$prefix" --component dev > "$work/install.log"
"$cmake" --install "$build" --prefix "$prefix" --component lcmtypes >> "$work/install.log"
cp -r "$source/examples" "$work/examples"
for example in "$work"/examples/*.cpp; do
  (($(wc -l < "$example") <= 40)) || fail "$(basename "$example") has more than 40 lines"
done

# configure NAME FLAGS [ARGUMENTS…]: configures the examples, and layout.cpp with every header.
configure() {
  local name=$1 flags=$2
  shift 2
  "$cmake" -S "$here/consumer" -B "$work/$name" -DCMAKE_PREFIX_PATH="$prefix" \
    -DEXAMPLES="$work/examples" -DCMAKE_CXX_FLAGS="$flags" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON "$@" \
    > "$work/$name.log" 2>&1 || { cat "$work/$name.log"; fail "configure $name"; }
}
make() {
  "$cmake" --build "$work/$1" --parallel 2 > "$work/$1.make" 2>&1 ||
    { tail -50 "$work/$1.make"; fail "build $1"; }
}

# With Eigen and a compiler: all other packages are hidden from CMake.
alone=()
for package in PkgConfig Threads fmt yaml-cpp nlohmann_json fcl spdlog CLI11 Python3; do
  alone+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON")
done
declare -A flags=(
  [plain]="-O2"
  [debug]="-O0 -g"
  [avx2]="-O3 -mavx2 -mfma -ffast-math"
  [native]="-O3 -march=native")
for name in plain debug avx2 native; do
  configure "$name" "${flags[$name]}" "${alone[@]}" &
done
wait
for name in plain debug avx2 native; do
  [[ -f "$work/$name/compile_commands.json" ]] || fail "configure $name: $(cat "$work/$name.log")"
  make "$name"
  for program in plan_a_path own_search own_sensor follow_targets layout; do
    "$work/$name/$program" > "$work/$name/$program.out" || fail "$name: $program"
    diff "$work/plain/$program.out" "$work/$name/$program.out" ||
      fail "$program prints something else with ${flags[$name]}"
  done
done
cat "$work/plain/plan_a_path.out"
grep -oE -e '-(I|isystem) ?[^ ]+' "$work/plain/compile_commands.json" | sort -u > "$work/includes"
if grep -vE "$prefix/include$|/eigen3$|-I$work/plain$" "$work/includes"; then
  fail "other include folders than the library's own and Eigen's"
fi
if ldd "$work/plain/plan_a_path" | grep -vE 'linux-vdso|ld-linux|libstdc|libm\.|libgcc_s|libc\.'; then
  fail "a planner needs other libraries than the compiler's"
fi

# Builds all components with the packages that they need; then requests missing components.
if pkg-config --exists lcm; then
  configure everything "-O2" -DWITH_BUS=ON
  make everything
  "$work/everything/bus_node" memq:// 2 || fail "bus_node"
  xz -dkc "$source/logs/sample/lab_60s.lcmlog.xz" > "$work/sample.lcmlog"
  "$work/everything/read_log" "$work/sample.lcmlog" > "$work/read_log.out" || fail "read_log"
  grep -q 'last belief contains' "$work/read_log.out" || fail "read_log found no beliefs"
fi
for earlier in "$source"/test/data/releases/*/examples.tar.xz; do
  name=$(basename "$(dirname "$earlier")")
  mkdir "$work/$name.source"
  tar -xJf "$earlier" -C "$work/$name.source"
  "$cmake" -S "$work/$name.source/examples" -B "$work/$name" -DCMAKE_PREFIX_PATH="$prefix" > "$work/$name.log" 2>&1 ||
    { cat "$work/$name.log"; fail "configure the examples of $name"; }
  make "$name"
  for program in plan_a_path own_search own_sensor follow_targets; do
    "$work/$name/$program" > "$work/$name/$program.out" || fail "$name: $program"
  done
done
mkdir "$work/wrong"
cat > "$work/wrong/CMakeLists.txt" << 'END'
cmake_minimum_required(VERSION 3.25)
project(wrong LANGUAGES CXX)
find_package(vantage REQUIRED COMPONENTS ${COMPONENT})
END
# refused COMPONENT WORDS [ARGUMENTS…]: expects that configuring fails with WORDS.
refused() {
  local component=$1 words=$2
  shift 2
  rm -rf "$work/wrong/build"
  if "$cmake" -S "$work/wrong" -B "$work/wrong/build" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCOMPONENT="$component" "$@" > "$work/wrong/log" 2>&1; then
    fail "component $component was found"
  fi
  tr '\n' ' ' < "$work/wrong/log" | tr -s ' ' | grep -qF "$words" ||
    { cat "$work/wrong/log"; fail "component $component is not refused with: $words"; }
}
refused gripper "unknown component 'gripper'; components are core, models"
refused bus "component 'bus' needs" -DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig=ON
refused scenario_reader "component 'scenario_reader' needs yaml-cpp" -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON
