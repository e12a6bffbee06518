/// Declaration of every parameter, in one place: name, type, presence, range and meaning. The checks of input
/// (validate.hpp) and the manual page (parameters/print.hpp) follow from it.
///
///     ListSpec section;
///     section.add(real("GIt").above(0.0).required().means("torsional stiffness, force * length^2"));
///     scene.add_list("Sections", ListSpec("the sections").with_named_lists("section", section, 1),
///     Presence::required);
#pragma once

#include "discretization/parameters/value.hpp"

#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

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

struct ParameterSpec {
  std::string name;
  ParameterType type = ParameterType::real;
  Presence presence = Presence::optional;
  ParameterValue default_value;
  Range range;
  int length = 0;                    ///< arrays: number of values; 0: any
  bool empty_allowed = false;        ///< arrays: may be empty
  double shortest = 0.0;             ///< vectors: smallest Euclidean norm, below which there is no direction
  std::vector<std::string> choices;  ///< strings and arrays of strings: allowed values; empty: any
  std::string other_words;           ///< describes other texts that are allowed, and checked elsewhere
  std::vector<std::string> words;    ///< numbers: strings (or booleans of these names) allowed instead
  std::string meaning;               ///< one sentence, with units and frame

  // The declaration reads as a sentence: real("EA").above(0.0).required().means("axial stiffness, force").
  ParameterSpec required() const { return with(&ParameterSpec::presence, Presence::required); }
  ParameterSpec by_default(const ParameterValue& value) const;
  /// The default is the initial value of the field that the parameter is bound to (binding.hpp).
  ParameterSpec by_default() const { return with(&ParameterSpec::presence, Presence::defaulted); }
  ParameterSpec at_least(double minimum) const { return with_range(&Range::minimum, minimum); }
  ParameterSpec at_most(double maximum) const { return with_range(&Range::maximum, maximum); }
  ParameterSpec above(double minimum) const { return at_least(minimum).with_range(&Range::minimum_excluded, true); }
  ParameterSpec below(double maximum) const { return at_most(maximum).with_range(&Range::maximum_excluded, true); }
  ParameterSpec or_infinite() const { return with_range(&Range::infinity_allowed, true); }
  ParameterSpec or_empty() const { return with(&ParameterSpec::empty_allowed, true); }
  ParameterSpec longer_than(double norm) const { return with(&ParameterSpec::shortest, norm); }
  ParameterSpec or_one_of(const std::vector<std::string>& allowed) const {
    return with(&ParameterSpec::words, allowed);
  }
  ParameterSpec or_other(const std::string& what) const { return with(&ParameterSpec::other_words, what); }
  ParameterSpec means(const std::string& sentence) const { return with(&ParameterSpec::meaning, sentence); }

 private:
  template <class Value>
  ParameterSpec with(Value ParameterSpec::*member, const Value& value) const {
    ParameterSpec spec = *this;
    spec.*member = value;
    return spec;
  }
  template <class Value>
  ParameterSpec with_range(Value Range::*bound, Value value) const {
    ParameterSpec spec = *this;
    spec.range.*bound = value;
    return spec;
  }
};

ParameterSpec boolean(const std::string& name);
ParameterSpec integer(const std::string& name);
ParameterSpec real(const std::string& name);
ParameterSpec text(const std::string& name);
ParameterSpec choice(const std::string& name, const std::vector<std::string>& choices);
ParameterSpec array(const std::string& name, ParameterType type, int length = 0);
/// Array of three numbers.
ParameterSpec vector3(const std::string& name);
/// Array of any of the given words, each at most once.
ParameterSpec subset(const std::string& name, const std::vector<std::string>& choices);

struct SublistSpec;

/// One combination of entries that a list may have.
struct Form {
  std::vector<std::string> needed, optional{};
};

/// Declaration of a list: parameters and lists of fixed names, and either parameters or lists of free names.
struct ListSpec {
  ListSpec() = default;
  explicit ListSpec(std::string sentence);

  std::string meaning;
  std::vector<ParameterSpec> parameters;
  std::vector<SublistSpec> sublists;
  std::string form_parameter;                      ///< parameter whose word selects the allowed forms
  std::map<std::string, std::vector<Form>> forms;  ///< by that word; names in none of them are always allowed
  std::vector<std::string> formless;               ///< names allowed only without that parameter
  std::vector<std::string> removed;  ///< parameters of earlier versions: validate() warns and goes on without them
  std::shared_ptr<const ParameterSpec> named_parameter;  ///< declaration of parameters with free names
  std::shared_ptr<const ListSpec> named_list;            ///< declaration of lists with free names
  std::string placeholder;                               ///< stands for the free name in the manual: `point`
  int minimum_named = 0;                                 ///< least number of free names
  bool unchecked = false;                                ///< any content: this list is checked elsewhere

  ListSpec& add(const ParameterSpec& parameter);
  ListSpec& add(const ParameterSpec& parameter, const std::string& sentence) { return add(parameter.means(sentence)); }
  ListSpec& add_list(const std::string& name, const ListSpec& list, Presence presence = Presence::defaulted);
  ListSpec& with_named_parameters(const std::string& placeholder_name, const ParameterSpec& parameter, int minimum = 0);
  ListSpec& with_named_lists(const std::string& placeholder_name, const ListSpec& list, int minimum = 0);
  /// Makes the other entries that are needed or allowed depend on the word given by `parameter`.
  ListSpec& with_forms(const std::string& parameter, const std::map<std::string, std::vector<Form>>& forms_of_words);
  /// Allows these entries only if the parameter of the forms is absent.
  ListSpec& without_form(const std::vector<std::string>& names);
  ListSpec& without_checks();
  /// Accepts, with a warning, a parameter of earlier versions that no result depends on.
  ListSpec& had_once(const std::string& name);

  const ParameterSpec* find_parameter(const std::string& name) const;
  const SublistSpec* find_list(const std::string& name) const;
  /// Declaration of a parameter or list of this name, fixed or free; nullptr: there is none.
  const ParameterSpec* parameter(const std::string& name) const;
  const ListSpec* list(const std::string& name) const;
  /// All fixed names, parameters first.
  std::vector<std::string> fixed_names() const;
};

struct SublistSpec {
  std::string name;
  Presence presence = Presence::defaulted;
  std::shared_ptr<const ListSpec> list;
};

/// Allowed values of a parameter in words: `double, value > 0, or inf`.
std::string allowed_values(const ParameterSpec& parameter);

/// Whether the value is a formula in place of a number. For a number with other words, any text is a formula.
bool stands_for_number(const ParameterValue& value, const ParameterSpec& spec);

}  // namespace mixbeam
