#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

// What of Eigen may stand in a header. A program may be built with other flags
// than the library that it links, and Eigen aligns what fills whole registers
// by them: 16 bytes without AVX, 32 with it, 64 with AVX-512. So types of 32
// bytes or a multiple of them are not aligned here, and matrices on the heap,
// which either side would free in its own way, do not stand in headers
// (docs/decisions/0010).

namespace vantage {

/// Option of a matrix whose layout is the same whatever flags a file is
/// compiled with.
inline constexpr int kUnaligned = Eigen::ColMajor | Eigen::DontAlign;

using Quaternion = Eigen::Quaternion<double, Eigen::DontAlign>;

// Two and three doubles are the same everywhere, unless Eigen is told
// otherwise.
static_assert(alignof(Eigen::Vector2d) == 16 && alignof(Eigen::Vector3d) == 8 &&
                  !Eigen::Matrix3d::IsRowMajor,
              "vantage's libraries have Eigen's own alignment and column-major "
              "storage: compile "
              "without EIGEN_DONT_ALIGN, EIGEN_MAX_STATIC_ALIGN_BYTES=0, "
              "EIGEN_DONT_VECTORIZE alone and EIGEN_DEFAULT_TO_ROW_MAJOR");
static_assert(sizeof(std::vector<int>) == 3 * sizeof(int*),
              "vantage's libraries have the plain containers: compile without "
              "_GLIBCXX_DEBUG");

}  // namespace vantage
