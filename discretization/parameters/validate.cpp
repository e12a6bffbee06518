#include "discretization/parameters/validate.hpp"

#include "discretization/parameters/access.hpp"
#include "discretization/parameters/formula_value.hpp"
#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <type_traits>

namespace mixbeam {
namespace {

using Teuchos::ParameterEntry;
using Teuchos::ParameterList;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string type_of(const ParameterValue& value) {
  if (std::holds_alternative<std::monostate>(value)) return "a type that XML does not know";
  return "type " + xml_name(static_cast<ParameterType>(value.index() - 1));
}

/// A whole number is a real number too.
ParameterValue widened(const ParameterValue& value, ParameterType type) {
  if (type == ParameterType::real && std::holds_alternative<int>(value)) {
    return static_cast<double>(std::get<int>(value));
  }
  if (type == ParameterType::real_array && std::holds_alternative<Teuchos::Array<int>>(value)) {
    const auto& integers = std::get<Teuchos::Array<int>>(value);
    return Teuchos::Array<double>(integers.begin(), integers.end());
  }
  return value;
}

bool in_range(double number, const Range& range) {
  if (std::isnan(number)) return false;
  if (std::isinf(number)) return range.infinity_allowed && number > 0.0;
  if (range.minimum_excluded ? number <= range.minimum : number < range.minimum) return false;
  return range.maximum_excluded ? number < range.maximum : number <= range.maximum;
}

bool numbers_in_range(const ParameterValue& value, const Range& range) {
  const auto check = [&range](const auto& held) {
    using Held = std::decay_t<decltype(held)>;
    if constexpr (std::is_same_v<Held, int> || std::is_same_v<Held, double>) return in_range(held, range);
    if constexpr (std::is_same_v<Held, Teuchos::Array<int>> || std::is_same_v<Held, Teuchos::Array<double>>) {
      for (const auto number : held) {
        if (!in_range(number, range)) return false;
      }
    }
    return true;
  };
  return std::visit(check, value);
}

int array_length(const ParameterValue& value) {
  const auto length = [](const auto& held) -> int {
    if constexpr (std::is_class_v<std::decay_t<decltype(held)>> &&
                  !std::is_same_v<std::decay_t<decltype(held)>, std::monostate>) {
      return static_cast<int>(held.size());
    }
    return 1;
  };
  return std::holds_alternative<std::string>(value) ? 1 : std::visit(length, value);
}

std::string described(const ParameterSpec& spec) {
  if (spec.meaning.empty()) return allowed_values(spec);
  const bool full_stop = spec.meaning.back() == '.';
  return allowed_values(spec) + " (" + spec.meaning.substr(0, spec.meaning.size() - (full_stop ? 1 : 0)) + ")";
}

bool is_long_enough(const ParameterValue& value, double shortest) {
  if (shortest == 0.0) return true;
  double norm = 0.0;
  for (const double component : std::get<Teuchos::Array<double>>(value)) norm = std::hypot(norm, component);
  return norm >= shortest;
}

/// Of words that must be among the choices, each at most once.
Problem problem_of_words(const ParameterValue& value, const ParameterSpec& spec) {
  Teuchos::Array<std::string> words;
  if (std::holds_alternative<std::string>(value)) words.push_back(std::get<std::string>(value));
  if (std::holds_alternative<Teuchos::Array<std::string>>(value)) words = std::get<Teuchos::Array<std::string>>(value);
  const std::string seen = "value " + excerpt(to_text(value)), allowed = "; allowed: " + described(spec);
  std::set<std::string> earlier;
  for (const std::string& word : words) {
    if (!contains(spec.choices, word) && spec.other_words.empty())
      return seen + allowed + did_you_mean(word, spec.choices);
    if (!earlier.insert(word).second) return seen + " says \"" + word + "\" twice" + allowed;
  }
  return "";
}

/// What keeps a list from being of some form.
struct Misfits {
  std::vector<std::string> missing, too_many;
  std::size_t needed_given = 0;
  std::size_t size() const { return missing.size() + too_many.size(); }
  /// Of two that miss as much, the form of which more was given is meant.
  bool is_nearer_than(const Misfits& other) const {
    return size() != other.size() ? size() < other.size() : needed_given > other.needed_given;
  }
};

/// All names that some form speaks of.
std::vector<std::string> names_of_forms(const ListSpec& spec) {
  std::vector<std::string> names;
  for (const std::string& name : spec.fixed_names())
    for (const auto& [word, forms] : spec.forms)
      for (const Form& form : forms)
        if ((contains(form.needed, name) || contains(form.optional, name)) && !contains(names, name))
          names.push_back(name);
  return names;
}

Misfits misfits(const ParameterList& list, const ListSpec& spec, const Form& form) {
  Misfits found;
  for (const std::string& name : form.needed)
    if (!list.isParameter(name) && !list.isSublist(name)) found.missing.push_back(name);
  found.needed_given = std::count_if(form.needed.begin(), form.needed.end(),
                                     [&](const std::string& name) { return is_given(list, name); });
  for (const std::string& name : names_of_forms(spec))
    if (is_given(list, name) && !contains(form.needed, name) && !contains(form.optional, name))
      found.too_many.push_back(name);
  return found;
}

/// `"Center", "Axis", "Angle"; or "Through"`
std::string described_forms(const ListSpec& spec, const std::vector<Form>& forms) {
  std::string text;
  for (const Form& form : forms) {
    std::vector<std::string> names = form.needed;
    names.insert(names.end(), form.optional.begin(), form.optional.end());
    text += (text.empty() ? "" : "; or ") +
            (names.empty() ? "none of " + quoted_list(names_of_forms(spec)) : quoted_list(names));
  }
  return text;
}

/// One walk over a list and its sublists; `path_` follows the walk.
class Validator {
 public:
  Validator(const ParameterSource& source, ParameterPath path, bool keep_formulas)
      : source_(source), path_(std::move(path)), keep_formulas_(keep_formulas) {}

  void check_list(ParameterList& list, const ListSpec& spec) {
    if (spec.unchecked) return;
    take_out_removed(list, spec);
    check_names(list, spec);
    for (const ParameterSpec& parameter : spec.parameters) {
      path_.push_back(parameter.name);
      check_parameter(list, parameter, parameter.name);
      path_.pop_back();
    }
    for (const SublistSpec& sublist : spec.sublists) {
      path_.push_back(sublist.name);
      check_sublist(list, sublist);
      path_.pop_back();
    }
    check_named_entries(list, spec);
    if (list.isParameter(spec.form_parameter)) check_form(list, spec, list.get<std::string>(spec.form_parameter));
  }

  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  InputError error(const std::string& problem) const { return source_.error(path_, problem); }

  void take_out_removed(ParameterList& list, const ListSpec& spec) {
    for (const std::string& name : spec.removed) {
      if (!list.isParameter(name) || list.isSublist(name)) continue;
      warnings_.push_back(source_.message(
          child(path_, name), "this parameter was removed and has no effect any more; the run goes on without it"));
      list.remove(name);
    }
  }

  /// Every entry must be declared, and be a list exactly where a list is declared.
  void check_names(const ParameterList& list, const ListSpec& spec) {
    for (auto entry = list.begin(); entry != list.end(); ++entry) {
      const std::string& name = list.name(entry);
      const bool is_list = list.entry(entry).isList();
      const bool parameter_declared = spec.find_parameter(name) != nullptr;
      const bool list_declared = spec.find_list(name) != nullptr;
      path_.push_back(name);
      if (parameter_declared && is_list) {
        throw error("a " + list_ + "; allowed: a " + parameter_ + ", " + allowed_values(*spec.find_parameter(name)));
      }
      if (list_declared && !is_list) throw error("a " + parameter_ + "; allowed: a " + list_ + " of this name");
      if (!parameter_declared && !list_declared) check_free_name(spec, name, is_list);
      path_.pop_back();
    }
  }

  void check_free_name(const ListSpec& spec, const std::string& name, bool is_list) const {
    const bool allowed = is_list ? spec.named_list != nullptr : spec.named_parameter != nullptr;
    const auto is_control = [](unsigned char c) { return c < ' ' || c == 127; };  // tables have a name in each line
    if (allowed && std::any_of(name.begin(), name.end(), is_control))
      throw error("a name with control characters; allowed: names of one line");
    if (allowed) return;
    const std::vector<std::string> names = spec.fixed_names();
    const std::string hint = did_you_mean(name, names);
    if (spec.named_list) throw error("a " + parameter_ + "; allowed: one " + list_ + " per " + spec.placeholder + hint);
    if (spec.named_parameter) {
      throw error("a " + list_ + "; allowed: one " + parameter_ + " per " + spec.placeholder + ", " +
                  allowed_values(*spec.named_parameter) + hint);
    }
    throw error("unknown name of a " + (is_list ? list_ : parameter_) + "; allowed: " + quoted_list(names) + hint);
  }

  /// A word in place of a number; booleans become the word of their name.
  static bool is_allowed_word(ParameterList& list, const ParameterSpec& spec, const std::string& name) {
    const ParameterValue given = value_of(*list.getEntryPtr(name));
    std::string word;
    if (std::holds_alternative<bool>(given)) word = to_text(given);
    if (std::holds_alternative<std::string>(given)) word = std::get<std::string>(given);
    if (!contains(spec.words, word)) return false;
    set_value(list, name, word);
    return true;
  }

  void check_parameter(ParameterList& list, const ParameterSpec& spec, const std::string& name) {
    const ParameterEntry* entry = list.getEntryPtr(name);
    if (entry == nullptr) {
      if (spec.presence == Presence::required) throw error("missing; needed: " + described(spec));
      if (spec.presence == Presence::defaulted) set_value(list, name, spec.default_value, true);
      return;
    }
    if (is_allowed_word(list, spec, name)) return;
    const ParameterValue given = value_of(*entry);
    if (keep_formulas_ && stands_for_number(given, spec)) return;
    const ParameterValue value = widened(given, spec.type);
    if (const Problem problem = problem_of(value, spec); !problem.empty()) throw error(of_formula(*entry) + problem);
    if (value.index() != given.index()) set_value(list, name, value);
  }

  /// What a value has come from.
  static std::string of_formula(const ParameterEntry& entry) {
    const ParameterValue written = written_value(entry).value;
    return written == value_of(entry) ? "" : "formula " + excerpt(to_text(written)) + ": ";
  }

  void check_sublist(ParameterList& list, const SublistSpec& spec) {
    if (!list.isSublist(spec.name)) {
      if (spec.presence == Presence::required) throw error("missing " + list_ + "; needed: " + spec.list->meaning);
      if (spec.presence == Presence::optional) return;
    }
    check_list(list.sublist(spec.name), *spec.list);
  }

  void check_named_entries(ParameterList& list, const ListSpec& spec) {
    if (!spec.named_list && !spec.named_parameter) return;
    std::vector<std::string> names;  // collected first: checking may replace a value
    for (auto entry = list.begin(); entry != list.end(); ++entry) {
      const std::string& name = list.name(entry);
      if (spec.find_parameter(name) == nullptr && spec.find_list(name) == nullptr) names.push_back(name);
    }
    if (static_cast<int>(names.size()) < spec.minimum_named) {
      throw error(std::to_string(names.size()) + " entries; allowed: at least " + std::to_string(spec.minimum_named) +
                  ", one per " + spec.placeholder);
    }
    for (const std::string& name : names) {
      path_.push_back(name);
      if (list.isSublist(name)) {
        check_list(list.sublist(name), *spec.named_list);
      } else {
        check_parameter(list, *spec.named_parameter, name);
      }
      path_.pop_back();
    }
  }

  /// Against the form of this word that is nearest to what was given.
  void check_form(const ParameterList& list, const ListSpec& spec, const std::string& word) const {
    const std::vector<Form>& forms = spec.forms.at(word);
    Misfits nearest = misfits(list, spec, forms.front());
    for (const Form& form : forms)
      if (Misfits other = misfits(list, spec, form); other.is_nearer_than(nearest)) nearest = std::move(other);
    if (nearest.size() == 0) return;
    const bool missing = !nearest.missing.empty();
    const std::string& name = missing ? nearest.missing.front() : nearest.too_many.front();
    const std::string what = spec.find_list(name) != nullptr ? "missing " + list_ : "missing";
    throw source_.error(child(path_, name), (missing ? what + "; needed" : "given, but has no meaning") + " for \"" +
                                                spec.form_parameter + "\" = \"" + word +
                                                "\"; allowed with it: " + described_forms(spec, forms));
  }

  const ParameterSource& source_;
  const std::string list_ = source_.list_word(), parameter_ = source_.parameter_word();
  ParameterPath path_;
  bool keep_formulas_;
  std::vector<std::string> warnings_;
};

}  // namespace

Problem problem_of(const ParameterValue& value, const ParameterSpec& spec) {
  const std::string seen = "value " + excerpt(to_text(value)), allowed = "; allowed: " + described(spec);
  if (!has_type(value, spec.type)) return seen + " of " + type_of(value) + allowed;
  const int length = array_length(value);
  if (spec.length > 0 && length != spec.length) return seen + " has " + std::to_string(length) + " entries" + allowed;
  if (length == 0 && !spec.empty_allowed) return seen + " is empty" + allowed;
  if (!numbers_in_range(value, spec.range)) return seen + allowed;
  if (!is_long_enough(value, spec.shortest)) return seen + " has no direction" + allowed;
  return spec.choices.empty() ? "" : problem_of_words(value, spec);
}

std::vector<std::string> validate(ParameterList& list, const ListSpec& spec, const ParameterSource& source,
                                  const ParameterPath& path, bool keep_formulas) {
  Validator validator(source, path, keep_formulas);
  validator.check_list(list, spec);
  return validator.warnings();
}

}  // namespace mixbeam
