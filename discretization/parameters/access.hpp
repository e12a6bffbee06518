/// Looking into a validated list of parameters.
#pragma once

#include "kernels/math/vector_algebra.hpp"

#include <Teuchos_Array.hpp>
#include <Teuchos_ParameterList.hpp>

#include <string>
#include <vector>

namespace mixbeam {

/// Names of all entries, in the order of the file.
inline std::vector<std::string> names_of(const Teuchos::ParameterList& list) {
  std::vector<std::string> names;
  for (auto entry = list.begin(); entry != list.end(); ++entry) names.push_back(list.name(entry));
  return names;
}

/// Whether the user gave this parameter, as opposed to its default; or this list.
inline bool is_given(const Teuchos::ParameterList& list, const std::string& name) {
  return list.isSublist(name) || (list.isParameter(name) && !list.getEntry(name).isDefault());
}

inline Vector3 get_vector(const Teuchos::ParameterList& list, const std::string& name) {
  const auto& values = list.get<Teuchos::Array<double>>(name);
  return {values[0], values[1], values[2]};
}

}  // namespace mixbeam
