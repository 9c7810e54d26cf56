#!/usr/bin/env bash
# Builds libFuzzer programs of the Vicon protocols with clang, ASan and UBSan (not part of the build):
#   test/fuzz/vicon/build.sh FOLDER
#   FOLDER/fuzz_client_kVrpn -runs=10000000 -max_len=4096 NEW_FOLDER FOLDER/samples
set -euo pipefail
out=${1:?folder for the programs}
cd "$(dirname "$0")/../../.."
mkdir -p "$out/objects"
flags=(-std=c++20 -O2 -g1 -I. -isystem /usr/include/eigen3 -fno-sanitize-recover=all
  -fsanitize=fuzzer-no-link,address,undefined)
sources=(core/pose.cpp core/check.cpp scenario/mocap_spec.cpp
  wire/vicon/*.cpp drivers/vicon/*.cpp sim/vicon/*.cpp test/fuzz/vicon/harness.cpp)
objects=()
for source in "${sources[@]}"; do
  [[ "$source" == *.cpp && "$source" != *socket_* ]] || continue
  object="$out/objects/${source//\//_}.o"
  clang++ "${flags[@]}" -c "$source" -o "$object"
  objects+=("$object")
done
for target in fuzz_client:kDataStream fuzz_client:kObjectStream fuzz_client:kVrpn \
              fuzz_server:kDataStream fuzz_server:kVrpn; do
  call=${target%:*} protocol=${target#*:}
  clang++ "${flags[@]}" -fsanitize=fuzzer \
    "-DVANTAGE_FUZZ_TARGET(input)=vantage::test::$call(MocapProtocol::$protocol, input)" \
    test/fuzz/vicon/libfuzzer.cpp "${objects[@]}" -o "$out/${call}_$protocol"
done
mkdir -p "$out/samples"
clang++ "${flags[@]}" -fsanitize=address,undefined test/fuzz/vicon/write_samples.cpp \
  "${objects[@]}" -o "$out/write_samples"
"$out/write_samples" "$out/samples"
