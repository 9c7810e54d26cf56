#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "core/check.hpp"
#include "core/pose.hpp"

// Shared parts of the module's bindings. Work longer than a few microseconds runs without the
// interpreter's lock, but with a mutex per object. A thread that holds the interpreter's lock must
// not wait for such a mutex.

namespace vantage::python {

namespace py = pybind11;

/// C-ordered array of doubles as argument; other arrays are converted.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

void bind_planning(py::module_& module);
void bind_team(py::module_& module);
void bind_scenario(py::module_& module);
void bind_trial(py::module_& module);
void bind_logs(py::module_& module);
void bind_models(py::module_& module);
void bind_env(py::module_& module);

/// Returns `value` as JSON text; numpy numbers and arrays are allowed. @throws Python's TypeError
/// for other types.
inline std::string json_text(const py::object& value) {
  return py::cast<std::string>(py::module_::import("vantage._arguments").attr("to_json")(value));
}
/// Returns the Python object of a JSON text; the inverse of json_text().
inline py::object from_json(const std::string& text) {
  return py::module_::import("json").attr("loads")(text);
}
/// Returns the path given as str or os.PathLike.
inline std::string path_text(const py::object& path) {
  return py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
}

/// @throws ValueError unless `array` has this shape; −1 allows any size.
inline void require_shape(const Doubles& array, const std::vector<py::ssize_t>& shape,
                          const char* name) {
  bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
  std::string words;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    fits = fits && (shape[i] < 0 || array.shape(static_cast<py::ssize_t>(i)) == shape[i]);
    words += (i == 0 ? "" : ", ") + (shape[i] < 0 ? std::string("any") : std::to_string(shape[i]));
  }
  if (!fits) {
    throw py::value_error(std::string(name) + ": must have the shape (" + words + ")");
  }
}

/// Returns the enumerator named `word`. @throws UsageError that lists the valid names.
template <class Kind>
Kind kind_of(const std::string& word, const std::map<std::string, Kind>& kinds,
             const char* argument = "kind") {
  const auto found = kinds.find(word);
  if (found == kinds.end()) {
    std::string words;
    for (const auto& [name, kind] : kinds) {
      words += (words.empty() ? "" : ", ") + name;
    }
    throw UsageError(std::string(argument) + ": must be one of " + words + ", got " + word);
  }
  return found->second;
}

inline Pose2 pose_of(const Doubles& array, const char* name) {
  require_shape(array, {3}, name);
  return {array.at(0), array.at(1), array.at(2)};
}

template <class Vector>
py::array_t<double> array_of(const Vector& vector) {
  py::array_t<double> out(static_cast<py::ssize_t>(vector.size()));
  for (py::ssize_t i = 0; i < out.size(); ++i) {
    out.mutable_at(i) = vector(static_cast<Eigen::Index>(i));
  }
  return out;
}

/// Converts a matrix to an array (rows, columns).
template <class Matrix>
py::array_t<double> matrix_array(const Matrix& matrix) {
  py::array_t<double> out(
      {static_cast<py::ssize_t>(matrix.rows()), static_cast<py::ssize_t>(matrix.cols())});
  auto view = out.template mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < view.shape(0); ++i) {
    for (py::ssize_t j = 0; j < view.shape(1); ++j) {
      view(i, j) = matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  return out;
}

/// Converts the first `count` poses to an array (count, 3): x, y in m, yaw in rad.
inline py::array_t<double> poses_array(const std::vector<Pose2>& poses, std::size_t count) {
  py::array_t<double> out({static_cast<py::ssize_t>(count), py::ssize_t{3}});
  auto view = out.mutable_unchecked<2>();
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    view(row, 0) = poses[i].x_m;
    view(row, 1) = poses[i].y_m;
    view(row, 2) = poses[i].yaw_rad;
  }
  return out;
}

}  // namespace vantage::python
