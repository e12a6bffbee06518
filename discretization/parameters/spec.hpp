/// The one declaration of every parameter: its name, type, presence, range and meaning. From it come the checks of
/// what a user wrote (validate.hpp) and the manual page (parameters/print.hpp).
///
///     ListSpec section;
///     section.add(real("GIt").above(0.0).required().means("torsional stiffness, force * length^2"));
///     scene.add_list("Sections", ListSpec("the sections").with_named_lists("section", section, 1),
///     Presence::required);
#pragma once

#include <Teuchos_Array.hpp>

#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace mixbeam {

/// No array of booleans: Teuchos cannot store one.
enum class ParameterType { boolean, integer, real, text, integer_array, real_array, text_array };

/// `Array(double)`: the type as written in XML.
std::string xml_name(ParameterType type);

enum class Presence {
  required,   ///< absent: an error
  defaulted,  ///< absent: the default is filled in; a list is filled with its own defaults
  optional    ///< absent: stays absent
};

/// Values that a number, or every number of an array, may take. NaN is never allowed.
struct Range {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool minimum_excluded = false;
  bool maximum_excluded = false;
  bool infinity_allowed = false;
};

using ParameterValue = std::variant<std::monostate, bool, int, double, std::string, Teuchos::Array<int>,
                                    Teuchos::Array<double>, Teuchos::Array<std::string>>;

struct ParameterSpec {
  std::string name;
  ParameterType type = ParameterType::real;
  Presence presence = Presence::optional;
  ParameterValue default_value;
  Range range;
  int length = 0;                    ///< arrays: how many values; 0: any number
  bool empty_allowed = false;        ///< arrays: no value at all is allowed too
  std::vector<std::string> choices;  ///< strings and arrays of strings: the only ones allowed; none given: any
  std::vector<std::string> words;    ///< numbers: strings (or booleans of these names) that may stand in their place
  std::string meaning;               ///< one sentence, with units and frame

  // The declaration reads as a sentence: real("EA").above(0.0).required().means("axial stiffness, force").
  ParameterSpec required() const;
  ParameterSpec by_default(const ParameterValue& value) const;
  ParameterSpec at_least(double minimum) const;
  ParameterSpec at_most(double maximum) const;
  ParameterSpec above(double minimum) const;
  ParameterSpec below(double maximum) const;
  ParameterSpec or_infinite() const;
  ParameterSpec or_empty() const;
  ParameterSpec or_one_of(const std::vector<std::string>& words) const;
  ParameterSpec means(const std::string& sentence) const;
};

ParameterSpec boolean(const std::string& name);
ParameterSpec integer(const std::string& name);
ParameterSpec real(const std::string& name);
ParameterSpec text(const std::string& name);
ParameterSpec choice(const std::string& name, const std::vector<std::string>& choices);
ParameterSpec array(const std::string& name, ParameterType type, int length = 0);
/// Three components.
ParameterSpec vector3(const std::string& name);
/// Any of the given words, each at most once.
ParameterSpec subset(const std::string& name, const std::vector<std::string>& choices);

struct SublistSpec;

/// What a list may contain: parameters and lists of fixed names, and either parameters or lists of free names.
struct ListSpec {
  ListSpec() = default;
  explicit ListSpec(std::string sentence);

  std::string meaning;
  std::vector<ParameterSpec> parameters;
  std::vector<SublistSpec> sublists;
  std::vector<std::string> removed;  ///< parameters of earlier versions: validate() warns and goes on without them
  std::shared_ptr<const ParameterSpec> named_parameter;  ///< what every parameter of a free name must be
  std::shared_ptr<const ListSpec> named_list;            ///< what every list of a free name must be
  std::string placeholder;                               ///< stands for the free name in the manual: `point`
  int minimum_named = 0;                                 ///< how many free names there must be
  bool unchecked = false;                                ///< anything goes: somebody else checks this list

  ListSpec& add(const ParameterSpec& parameter);
  ListSpec& add_list(const std::string& name, const ListSpec& list, Presence presence = Presence::defaulted);
  ListSpec& with_named_parameters(const std::string& placeholder_name, const ParameterSpec& parameter, int minimum = 0);
  ListSpec& with_named_lists(const std::string& placeholder_name, const ListSpec& list, int minimum = 0);
  ListSpec& without_checks();
  /// A parameter that earlier versions had, and that no result depends on.
  ListSpec& had_once(const std::string& name);

  const ParameterSpec* find_parameter(const std::string& name) const;
  const SublistSpec* find_list(const std::string& name) const;
  /// All fixed names, parameters first.
  std::vector<std::string> fixed_names() const;
};

struct SublistSpec {
  std::string name;
  Presence presence = Presence::defaulted;
  std::shared_ptr<const ListSpec> list;
};

/// `double, value > 0, or inf`: what may be written for this parameter.
std::string allowed_values(const ParameterSpec& parameter);

/// `"text"`, `0.5`, `true`, `{1, 2, 3}`.
std::string to_text(const ParameterValue& value);

}  // namespace mixbeam
