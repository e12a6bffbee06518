#include "discretization/parameters/validate.hpp"

#include "discretization/parameters/value.hpp"
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

/// Converts integers to reals if reals are declared.
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

/// Problem of words that must be among the choices, each at most once.
Problem problem_of_words(const ParameterValue& value, const ParameterSpec& spec) {
  Teuchos::Array<std::string> words;
  if (std::holds_alternative<std::string>(value)) words.push_back(std::get<std::string>(value));
  if (std::holds_alternative<Teuchos::Array<std::string>>(value)) words = std::get<Teuchos::Array<std::string>>(value);
  const auto told = [&](const std::string& problem) {
    return "value " + excerpt(to_text(value)) + problem + "; allowed: " + described(spec);
  };
  std::set<std::string> earlier;
  for (const std::string& word : words) {
    if (!contains(spec.choices, word) && spec.other_words.empty()) return told("") + did_you_mean(word, spec.choices);
    if (!earlier.insert(word).second) return told(" says \"" + word + "\" twice");
  }
  return "";
}

/// Entries in which a list differs from a form.
struct Misfits {
  std::vector<std::string> missing, too_many;
  std::size_t needed_given = 0;
  std::size_t size() const { return missing.size() + too_many.size(); }
  /// The nearer form differs in fewer entries, or in as many and has more needed entries given.
  bool is_nearer_than(const Misfits& other) const {
    return size() != other.size() ? size() < other.size() : needed_given > other.needed_given;
  }
};

bool is_of(const Form& form, const std::string& name) {
  return contains(form.needed, name) || contains(form.optional, name);
}

bool is_of_some_form(const ListSpec& spec, const std::string& name) {
  for (const auto& [word, forms] : spec.forms)
    if (std::any_of(forms.begin(), forms.end(), [&](const Form& form) { return is_of(form, name); })) return true;
  return false;
}

/// All names that occur in some form.
std::vector<std::string> names_of_forms(const ListSpec& spec) {
  std::vector<std::string> names;
  for (const std::string& name : spec.fixed_names())
    if (is_of_some_form(spec, name)) names.push_back(name);
  return names;
}

Misfits misfits(const ParameterList& list, const ListSpec& spec, const Form& form) {
  Misfits found;
  for (const std::string& name : form.needed)
    if (!list.isParameter(name) && !list.isSublist(name)) found.missing.push_back(name);
  found.needed_given = std::count_if(form.needed.begin(), form.needed.end(),
                                     [&](const std::string& name) { return is_given(list, name); });
  const auto add_surplus = [&](const std::string& name) {
    if (is_given(list, name) && !is_of(form, name) && is_of_some_form(spec, name)) found.too_many.push_back(name);
  };
  for (const ParameterSpec& parameter : spec.parameters) add_surplus(parameter.name);
  for (const SublistSpec& sublist : spec.sublists) add_surplus(sublist.name);
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

bool is_array_value(const ParameterValue& value) {
  return value.index() > static_cast<std::size_t>(ParameterType::integer_array);
}

/// Visits a list and its sublists; `path_` is the current place.
class Validator {
 public:
  Validator(const ParameterSource& source, ParameterPath path, bool keep_formulas)
      : source_(source), path_(std::move(path)), keep_formulas_(keep_formulas) {}

  void check_list(ParameterList& list, const ListSpec& spec) {
    if (spec.unchecked) return;
    around_.push_back(&spec);
    take_out_removed(list, spec);
    const bool names_are_known = check_names(list, spec);
    for (const ParameterSpec& parameter : spec.parameters)
      check_parameter(list, parameter, parameter.name, names_are_known);
    for (const SublistSpec& sublist : spec.sublists)
      at(sublist.name, [&] { check_sublist(list, sublist, names_are_known); });
    check_named_entries(list, spec);
    if (list.isParameter(spec.form_parameter) && !(source_.has_mistakes() && source_.has_mistake(path_)))
      source_.attempt([&] { check_form(list, spec, list.get<std::string>(spec.form_parameter)); });
    around_.pop_back();
  }

  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  InputError error(const std::string& problem) const { return source_.error(path_, problem); }

  /// Runs the action one level deeper. False: it threw a mistake, which is kept.
  template <class Action>
  bool at(const std::string& name, const Action& action) {
    const std::size_t depth = path_.size();
    path_.push_back(name);
    const bool is_right = source_.attempt(action);
    path_.resize(depth);
    return is_right;
  }

  void take_out_removed(ParameterList& list, const ListSpec& spec) {
    for (const std::string& name : spec.removed) {
      if (!list.isParameter(name) || list.isSublist(name)) continue;
      warnings_.push_back(source_.message(
          child(path_, name), "this parameter was removed and has no effect any more; the run goes on without it"));
      list.remove(name);
    }
  }

  /// Every entry must be declared, and be a list exactly where a list is declared.
  bool check_names(ParameterList& list, const ListSpec& spec) {
    bool are_known = true;
    for (const std::string& name : names_of(list)) are_known = check_name(list, spec, name) && are_known;
    return are_known;
  }

  /// False: it is unknown which name was meant. Removes an entry of the wrong kind.
  bool check_name(ParameterList& list, const ListSpec& spec, const std::string& name) {
    const bool is_list = list.isSublist(name);
    const ParameterSpec* parameter = spec.find_parameter(name);
    if (parameter != nullptr && !is_list) return true;
    if (spec.find_list(name) != nullptr && is_list) return true;
    const bool is_right = at(name, [&] {
      if (parameter != nullptr)
        throw error("a " + list_ + "; allowed: a " + parameter_ + ", " + allowed_values(*parameter) +
                    example(*parameter));
      if (spec.find_list(name) != nullptr) {
        source_.cannot_mend();
        throw error("a " + parameter_ + "; allowed: a " + list_ + " of this name" +
                    contents_of(*spec.find_list(name)->list));
      }
      check_free_name(list, spec, name, is_list);
    });
    if (is_right) return true;
    const bool is_known = parameter != nullptr || spec.find_list(name) != nullptr || take_for_nearest(list, spec, name);
    list.remove(name);
    if (!is_known && is_list && spec.named_parameter) mend(list, *spec.named_parameter, name);
    if (!is_known && !is_list && spec.named_list) source_.cannot_mend();
    return is_known;
  }

  std::string contents_of(const ListSpec& spec) const {
    if (spec.named_list || spec.named_parameter)
      return ", with one " + (spec.named_list ? list_ : parameter_) + " per " + spec.placeholder;
    const std::vector<std::string> names = spec.fixed_names();
    return names.empty() ? "" : ", with " + quoted_list(names);
  }

  /// Reads an entry of an unknown name as the one that it seems to misspell.
  static bool take_for_nearest(ParameterList& list, const ListSpec& spec, const std::string& name) {
    const std::string nearest = nearest_name(name, names_that_fit(list, spec));
    const bool is_list = list.isSublist(name);
    if (nearest.empty() || list.isParameter(nearest) || is_list != (spec.find_list(nearest) != nullptr)) return false;
    if (is_list) {
      list.sublist(nearest).setParameters(list.sublist(name));
      return true;
    }
    const ParameterSpec& meant = *spec.find_parameter(nearest);
    const ParameterValue value = widened(value_of(list.getEntry(name)), meant.type);
    if (!problem_of(value, meant).empty()) return false;  // a second mistake there would follow from this one
    set_value(list, nearest, value);
    return true;
  }

  /// Names that the chosen form allows.
  static std::vector<std::string> names_that_fit(const ParameterList& list, const ListSpec& spec) {
    const auto* word =
        list.isType<std::string>(spec.form_parameter) ? &list.get<std::string>(spec.form_parameter) : nullptr;
    if (word == nullptr || spec.forms.count(*word) == 0) return spec.fixed_names();
    const std::vector<std::string> of_forms = names_of_forms(spec);
    std::vector<std::string> names;
    for (const std::string& name : spec.fixed_names()) {
      const auto has_name = [&](const Form& form) { return is_of(form, name); };
      const std::vector<Form>& forms = spec.forms.at(*word);
      const bool fits =
          contains(of_forms, name) ? std::any_of(forms.begin(), forms.end(), has_name) : !contains(spec.formless, name);
      if (fits) names.push_back(name);
    }
    return names;
  }

  /// Hint at another place in the file for a name: `; it belongs in the list "Material"`.
  std::string other_place_of(const std::string& name, const ListSpec& spec, bool is_list) const {
    const auto has_name = [&](const ListSpec& other) {
      return is_list ? other.find_list(name) != nullptr : other.find_parameter(name) != nullptr;
    };
    for (const SublistSpec& inner : spec.sublists)
      if (has_name(*inner.list)) return "; it belongs in the list \"" + inner.name + "\"";
    for (std::size_t depth = around_.size() - 1; depth-- > 0;) {
      if (!has_name(*around_[depth])) continue;
      const std::size_t first = path_.size() - around_.size();  // names in front of the outermost list here
      const std::string beside = "\"" + path_[first + depth] + "\"";
      return "; it belongs beside " + beside + ", not inside it";
    }
    return "";
  }

  void check_free_name(const ParameterList& list, const ListSpec& spec, const std::string& name, bool is_list) const {
    const bool allowed = is_list ? spec.named_list != nullptr : spec.named_parameter != nullptr;
    const auto is_control = [](unsigned char c) { return c < ' ' || c == 127; };  // tables list one name per line
    if (allowed && std::any_of(name.begin(), name.end(), is_control))
      throw error("a name with control characters; allowed: names of one line");
    if (allowed) return;
    const std::vector<std::string> names = names_that_fit(list, spec);
    const std::string elsewhere = other_place_of(name, spec, is_list);
    const std::string hint = elsewhere.empty() ? did_you_mean(name, names) : elsewhere;
    if (spec.named_list)
      throw error("a " + parameter_ + "; allowed: one " + list_ + " per " + spec.placeholder +
                  contents_of(*spec.named_list) + hint);
    if (spec.named_parameter) {
      throw error("a " + list_ + "; allowed: one " + parameter_ + " per " + spec.placeholder + ", " +
                  allowed_values(*spec.named_parameter) + example(*spec.named_parameter) + hint);
    }
    throw error("unknown name of a " + (is_list ? list_ : parameter_) + "; allowed: " + quoted_list(names) + hint);
  }

  /// A word in place of a number; booleans become the word of their name.
  static bool is_allowed_word(ParameterList& list, const ParameterSpec& spec, const std::string& name) {
    if (spec.words.empty()) return false;
    const ParameterValue given = value_of(*list.getEntryPtr(name));
    std::string word;
    if (std::holds_alternative<bool>(given)) word = to_text(given);
    if (std::holds_alternative<std::string>(given)) word = std::get<std::string>(given);
    if (!contains(spec.words, word)) return false;
    set_value(list, name, word);
    return true;
  }

  /// `is_needed`: reports a required parameter that is absent; false if an unknown name could stand for it.
  void check_parameter(ParameterList& list, const ParameterSpec& spec, const std::string& name, bool is_needed) {
    const ParameterEntry* entry = list.getEntryPtr(name);
    if (entry == nullptr && spec.presence == Presence::defaulted) set_value(list, name, spec.default_value, true);
    if (entry == nullptr && spec.presence != Presence::required) return;
    const bool is_right = at(name, [&] {
      if (entry == nullptr && is_needed) throw error("missing; needed: " + described(spec));
      if (entry == nullptr || is_allowed_word(list, spec, name)) return;
      const ParameterValue given = value_of(*entry);
      if (keep_formulas_ && stands_for_number(given, spec)) return;
      const ParameterValue value = widened(given, spec.type);
      if (const Problem problem = problem_of(value, spec); !problem.empty())
        throw error(of_formula(*entry) + problem + hint(value, spec, *around_.back()));
      if (value.index() != given.index()) set_value(list, name, value);
    });
    if (entry == nullptr || !is_right) mend(list, spec, name);
  }

  /// Prefix of a message: the formula that gave the value.
  static std::string of_formula(const ParameterEntry& entry) {
    const std::string written = to_text(written_value(entry).value);
    return written == to_text(value_of(entry)) ? "" : "formula " + excerpt(written) + ": ";  // as texts: NaN too
  }

  /// Replaces a wrong or missing value by an allowed one.
  void mend(ParameterList& list, const ParameterSpec& spec, const std::string& name) {
    list.remove(name, false);
    if (spec.presence == Presence::optional) return;
    const ParameterValue value = spec.presence == Presence::defaulted ? spec.default_value : something_allowed(spec);
    if (!std::holds_alternative<std::monostate>(value)) return set_value(list, name, value, true);
    source_.cannot_mend();
  }

  /// Array of entries: [1, 2] in YAML and Python, {1, 2} in XML.
  std::string bracketed(const std::string& entries) const {
    return source_.language() == InputLanguage::xml ? "{" + entries + "}" : "[" + entries + "]";
  }

  /// `, like [0, 0, 1]` for an array of numbers.
  std::string example(const ParameterSpec& spec) const {
    if (spec.type != ParameterType::real_array || spec.length == 0) return "";
    std::string entries = "1";
    for (int i = 1; i < spec.length; ++i) entries = "0, " + entries;
    return ", like " + bracketed(entries);
  }

  /// Suggestion for a value that is not allowed.
  std::string hint(const ParameterValue& value, const ParameterSpec& spec, const ListSpec& around) const {
    const auto meant = [](const std::string& text) { return "; did you mean " + text + "?"; };
    const auto* text = std::get_if<std::string>(&value);
    const auto* real = std::get_if<double>(&value);
    const std::string word = text != nullptr ? lower_case(*text) : "";
    const bool is_number = spec.type == ParameterType::real || spec.type == ParameterType::integer;
    if (text != nullptr && is_number) return number_hint(*text);
    if (real != nullptr && spec.type == ParameterType::integer && *real == std::floor(*real))
      return meant(rounded(*real, 9));
    if (text != nullptr && spec.type == ParameterType::boolean) {
      const bool is_no = contains({"no", "off", "n", "0"}, word);
      return is_no || contains({"yes", "on", "y", "1"}, word) ? meant(is_no ? "false" : "true") : "";
    }
    const bool is_text_array = spec.type == ParameterType::text_array;
    if (text != nullptr && is_text_array && spec.empty_allowed && contains({"none", "no", "free", ""}, word))
      return meant(bracketed(""));
    if (text != nullptr && is_text_array && (spec.choices.empty() || contains(spec.choices, word)))
      return meant(bracketed(*text));
    if (has_type(value, ParameterType::text_array) && is_array(spec.type) && !is_text_array) {
      const std::string formula = spec.name + " Formula";
      const bool has_formula = around.find_parameter(formula) != nullptr;
      for (const std::string& entry : std::get<Teuchos::Array<std::string>>(value))
        if (const std::string slip = number_hint(entry);
            !slip.empty() && !(has_formula && slip.find('=') < slip.size()))
          return slip;
      return has_formula ? meant("\"" + formula + "\"") : "";
    }
    if (spec.length > 0 && array_length(value) > spec.length)
      return "; decimals have a point: a comma separates entries";
    const bool is_short = is_array(spec.type) && (!is_array_value(value) || array_length(value) < spec.length);
    return is_short ? example(spec) : "";
  }

  void check_sublist(ParameterList& list, const SublistSpec& spec, bool is_needed) {
    if (!list.isSublist(spec.name)) {
      if (spec.presence == Presence::required) source_.cannot_mend();
      if (spec.presence == Presence::required && is_needed)
        throw error("missing " + list_ + "; needed: " + spec.list->meaning);
      if (spec.presence == Presence::optional) return;
    }
    check_list(list.sublist(spec.name), *spec.list);
  }

  void check_named_entries(ParameterList& list, const ListSpec& spec) {
    if (!spec.named_list && !spec.named_parameter) return;
    std::vector<std::string> names;  // collected first: checking may replace a value
    for (const std::string& name : names_of(list))
      if (spec.find_parameter(name) == nullptr && spec.find_list(name) == nullptr) names.push_back(name);
    source_.attempt([&] {
      if (static_cast<int>(names.size()) < spec.minimum_named)
        throw error(std::to_string(names.size()) + " entries; allowed: at least " + std::to_string(spec.minimum_named) +
                    ", one per " + spec.placeholder);
    });
    for (const std::string& name : names) {
      if (list.isSublist(name))
        at(name, [&] { check_list(list.sublist(name), *spec.named_list); });
      else
        check_parameter(list, *spec.named_parameter, name, true);
    }
  }

  /// Checks against the form of this word that is nearest to the given entries.
  void check_form(const ParameterList& list, const ListSpec& spec, const std::string& word) const {
    const std::vector<Form>& forms = spec.forms.at(word);
    Misfits nearest = misfits(list, spec, forms.front());
    for (std::size_t i = 1; i < forms.size() && nearest.size() > 0; ++i)
      if (Misfits other = misfits(list, spec, forms[i]); other.is_nearer_than(nearest)) nearest = std::move(other);
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
  std::vector<const ListSpec*> around_;  ///< declarations of the lists on the path, from the outermost one on
  std::vector<std::string> warnings_;
};

}  // namespace

Problem problem_of(const ParameterValue& value, const ParameterSpec& spec) {
  const auto told = [&](const std::string& problem) {
    return "value " + excerpt(to_text(value)) + problem + "; allowed: " + described(spec);
  };
  if (!has_type(value, spec.type)) return told(" of " + type_of(value));
  const int length = array_length(value);
  if (spec.length > 0 && length != spec.length) return told(" has " + std::to_string(length) + " entries");
  if (length == 0 && !spec.empty_allowed) return told(" is empty");
  if (!numbers_in_range(value, spec.range)) return told("");
  if (!is_long_enough(value, spec.shortest)) return told(" has no direction");
  return spec.choices.empty() ? "" : problem_of_words(value, spec);
}

ParameterValue something_allowed(const ParameterSpec& spec) {
  if (!spec.choices.empty() && spec.type == ParameterType::text) return spec.choices.front();
  const Range& range = spec.range;
  const double number = std::isfinite(range.minimum) && range.minimum >= 1.0 ? range.minimum
                        : std::isfinite(range.maximum) && range.maximum <= 1.0
                            ? 0.5 * (std::max(range.minimum, 0.0) + range.maximum)
                            : 1.0;
  switch (spec.type) {
    case ParameterType::boolean:
      return false;
    case ParameterType::integer:
      return static_cast<int>(number);
    case ParameterType::real:
      return number;
    case ParameterType::real_array:
      return Teuchos::Array<double>(std::max(spec.length, 1), number);
    default:
      return {};
  }
}

std::vector<std::string> validate(ParameterList& list, const ListSpec& spec, const ParameterSource& source,
                                  const ParameterPath& path, bool keep_formulas) {
  Validator validator(source, path, keep_formulas);
  source.collect([&] { validator.check_list(list, spec); });
  return validator.warnings();
}

}  // namespace mixbeam
