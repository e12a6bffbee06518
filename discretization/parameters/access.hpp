/// Looking into a validated list of parameters.
#pragma once

#include "discretization/scene/scene.hpp"

#include <Teuchos_Array.hpp>
#include <Teuchos_ParameterList.hpp>

#include <map>
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

inline Vector3 get_vector_or_zero(const Teuchos::ParameterList& list, const std::string& name) {
  return list.isParameter(name) ? get_vector(list, name) : Vector3{};
}

/// Empty if the parameter is absent.
inline std::string get_text_or_empty(const Teuchos::ParameterList& list, const std::string& name) {
  return list.isParameter(name) ? list.get<std::string>(name) : "";
}

/// Meaning of a word whose declared choices are the keys of `meanings`.
template <typename Meaning>
Meaning translated(const Teuchos::ParameterList& list, const std::string& name,
                   const std::map<std::string, Meaning>& meanings) {
  return meanings.at(list.get<std::string>(name));
}

}  // namespace mixbeam
