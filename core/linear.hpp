#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

// Eigen types allowed in public headers. A program may be built with other compiler flags than the
// library that it links. The alignment of some Eigen types depends on these flags: 16 bytes without
// AVX, 32 with AVX, 64 with AVX-512. Therefore a type is unaligned here if its size is a multiple
// of 32 bytes. Public headers contain no heap matrices, because program and library could free such
// a matrix in different ways (docs/decisions/0010).

namespace vantage {

/// Matrix option for a layout that does not depend on compiler flags.
inline constexpr int kUnaligned = Eigen::ColMajor | Eigen::DontAlign;

using Quaternion = Eigen::Quaternion<double, Eigen::DontAlign>;

// Vectors of two and three doubles have a fixed layout unless Eigen's options change it.
static_assert(
    alignof(Eigen::Vector2d) == 16 && alignof(Eigen::Vector3d) == 8 && !Eigen::Matrix3d::IsRowMajor,
    "vantage's libraries use Eigen's default alignment and column-major "
    "storage: compile without EIGEN_DONT_ALIGN, EIGEN_MAX_STATIC_ALIGN_BYTES=0 and "
    "EIGEN_DEFAULT_TO_ROW_MAJOR, and use EIGEN_DONT_VECTORIZE only with an alignment of 16 bytes");
static_assert(sizeof(std::vector<int>) == 3 * sizeof(int*),
              "vantage's libraries use standard containers without debug mode: compile without "
              "_GLIBCXX_DEBUG");

}  // namespace vantage
