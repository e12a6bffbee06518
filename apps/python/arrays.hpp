/// Conversion of the library's numbers to NumPy arrays: moved, or copied once.
#pragma once

#include "apps/python/guest.hpp"
#include "apps/python/solved_run.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <memory>
#include <utility>
#include <vector>

namespace mixbeam {

using Run = std::shared_ptr<SolvedRun>;

/// Moves a vector of numbers, or of rows of numbers, into an array.
template <class Row>
pybind11::array numbers(std::vector<Row> values) {
  constexpr std::size_t kColumns = sizeof(Row) / sizeof(double);
  std::vector<pybind11::ssize_t> shape = {static_cast<pybind11::ssize_t>(values.size())};
  if (kColumns > 1) shape.push_back(kColumns);
  auto owned = std::make_unique<std::vector<Row>>(std::move(values));
  const double* data = reinterpret_cast<const double*>(owned->data());
  const pybind11::capsule owner(owned.release(), [](void* held) { delete static_cast<std::vector<Row>*>(held); });
  return pybind11::array_t<double>(shape, data, owner);
}
inline pybind11::array numbers(const std::vector<int>& values) {
  return pybind11::array_t<int>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}
inline pybind11::array table(std::vector<double> values, std::size_t columns) {
  const std::size_t rows = columns == 0 ? 0 : values.size() / columns;
  return numbers(std::move(values)).reshape({rows, columns});
}

/// Calls the library while holding a Turn.
template <class Action>
auto in_turn(const Action& action) {
  const Turn turn;
  return action();
}

/// Name and entries of a parameter list: {name: [type, value] of a parameter, a dict of a list}.
pybind11::tuple parameters_of(const XmlParameters& parameters);

/// Adds the class of a run to the module.
void bind_run(pybind11::module_& module);
/// Adds problems with judged solutions, see judged_problem.cpp.
void bind_judged_problem(pybind11::module_& module);
/// Adds the classes for studies in Python, see study.cpp.
void bind_study(pybind11::module_& module);

}  // namespace mixbeam
