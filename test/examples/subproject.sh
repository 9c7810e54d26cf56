#!/usr/bin/env bash
# subproject.sh CMAKE BUILD SOURCE: builds the tree as a part of another project, with only Eigen
# and a compiler. The project has a program that uses the component models, with several sets of
# flags, and the first example of the component planner.
set -euo pipefail
cmake=$1 source=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }

mkdir "$work/project"
cat > "$work/project/CMakeLists.txt" << 'END'
cmake_minimum_required(VERSION 3.25)
project(other LANGUAGES CXX)
add_subdirectory(${VANTAGE} vantage EXCLUDE_FROM_ALL)
add_executable(turn turn.cpp)
target_link_libraries(turn PRIVATE vantage::models)
separate_arguments(flags UNIX_COMMAND "${TURN_FLAGS}")
target_compile_options(turn PRIVATE ${flags})
add_executable(plan_a_path ${VANTAGE}/examples/plan_a_path.cpp)
target_link_libraries(plan_a_path PRIVATE vantage::planner)
foreach(component planner estimator)
  if(NOT TARGET vantage::${component})
    message(FATAL_ERROR "no vantage::${component}")
  endif()
endforeach()
get_property(tests DIRECTORY ${VANTAGE} PROPERTY TESTS)
if(tests OR TARGET vantage::bus OR TARGET vantage-planner OR CMAKE_RUNTIME_OUTPUT_DIRECTORY)
  message(FATAL_ERROR "more than what was asked for")
endif()
END
cat > "$work/project/turn.cpp" << 'END'
#include <cstdio>
#include <vantage/models/belief/gaussian.hpp>
#include <vantage/models/motion/unicycle.hpp>
#if __has_include("core/pose.hpp")
#error "the folders of vantage are in everybody's way"
#endif
int main() {
  using namespace vantage::models;
  const TargetModel model{.kind = TargetKind::kDoubleIntegrator, .q = 0.1};
  Gaussian belief{Eigen::Vector4d(6.0, 3.0, 0.5, 0.0), Eigen::Matrix4d::Identity()};
  const SensorModel sensor;
  const Viewpoint from{{1.0, 2.0, 0.1}, 0.0};
  for (int i = 0; i < 5; ++i) {
    belief = predict(belief, model.transition(0.5), model.process_noise(0.5));
    const PositionMatrix M = information(sensor, from, belief.mean.head(2));
    belief.covariance = update_covariance(belief.covariance, M);
  }
  std::printf("%.12f\n", log_det(belief.covariance));
  const auto end = vantage::models::step_unicycle({0.0, 0.0, 0.0}, {1.0, 1.0}, 1.0);
  std::printf("%.6f %.6f %.6f\n", end.x_m, end.y_m, end.yaw_rad);
}
END
alone=()
for package in PkgConfig Threads fmt yaml-cpp nlohmann_json fcl spdlog CLI11 Python3 GTest benchmark; do
  alone+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON")
done
"$cmake" -S "$work/project" -B "$work/build" -DVANTAGE="$source" -DVANTAGE_UNITY=ON "${alone[@]}" > "$work/log" 2>&1 ||
  { cat "$work/log"; fail "configure"; }
for flags in "-O2" "-O3 -mavx2 -mfma" "-O3 -march=native"; do
  "$cmake" "$work/build" -DTURN_FLAGS="$flags" > "$work/log" 2>&1 || { cat "$work/log"; fail "$flags"; }
  "$cmake" --build "$work/build" --parallel 2 --target turn > "$work/make" 2>&1 ||
    { tail -50 "$work/make"; fail "build with $flags"; }
  said=$("$work/build/turn") || fail "turn built with $flags"
  echo "$said"
  [[ "$said" == "${first:=$said}" ]] || fail "turn prints something else when built with $flags"
done
[[ "$said" == *"0.841471 0.459698 1.000000" ]] || fail "turn prints $said"
"$cmake" --build "$work/build" --parallel 2 --target plan_a_path > "$work/make" 2>&1 ||
  { tail -50 "$work/make"; fail "build plan_a_path"; }
"$work/build/plan_a_path" || fail "plan_a_path"
# -O3 and sealing apply only to the library itself.
if nm "$work/build/vantage/models/libvantage_models.a" | grep -E ' [VWu] ' | grep -v ' _ZT[VTIS]N7vantage'
then
  fail "not sealed"
fi
