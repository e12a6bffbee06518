/// Parameters bound to the fields of a struct. One line declares name, type, range, default and meaning of a parameter
/// and names its field; from it follow the declaration (spec.hpp), reading, comparison and columns of tables.
///
///     BoundList<Joint> joint("A connection that gives way.");
///     joint.bind(&Joint::kind, text("Kind").required(), "hinge: ...", {{"hinge", JointKind::hinge}, ...});
///     joint.bind(&Joint::stiffness, real("Stiffness").at_least(0.0).by_default(), "of a spring"...);
///     joint.read(list, object);
#pragma once

#include "discretization/parameters/spec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace mixbeam {

/// Conversion between fields and values of parameters.
namespace binding {

template <class T>
inline constexpr bool is_plain =
    std::is_same_v<T, bool> || std::is_same_v<T, int> || std::is_same_v<T, double> || std::is_same_v<T, std::string>;

template <class T>
std::enable_if_t<is_plain<T>, ParameterValue> value_from(const T& field) {
  return field;
}
template <class T, std::size_t n>
ParameterValue value_from(const std::array<T, n>& field) {
  return Teuchos::Array<T>(field.begin(), field.end());
}
template <class T>
ParameterValue value_from(const std::vector<T>& field) {
  return Teuchos::Array<T>(field);
}
template <class T>
ParameterValue value_from(const std::optional<T>& field) {
  return field ? value_from(*field) : ParameterValue{};
}

template <class T>
std::enable_if_t<is_plain<T>> assign(T& field, const ParameterValue& value) {
  field = std::get<T>(value);
}
template <class T, std::size_t n>
void assign(std::array<T, n>& field, const ParameterValue& value) {
  const auto& values = std::get<Teuchos::Array<T>>(value);
  std::copy(values.begin(), values.end(), field.begin());
}
template <class T>
void assign(std::vector<T>& field, const ParameterValue& value) {
  const auto& values = std::get<Teuchos::Array<T>>(value);
  field.assign(values.begin(), values.end());
}
template <class T>
void assign(std::optional<T>& field, const ParameterValue& value) {
  assign(field.emplace(), value);
}

template <class T>
T& present(T& part) {
  return part;
}
template <class T>
T& present(std::optional<T>& part) {
  return part ? *part : part.emplace();
}

}  // namespace binding

/// One parameter of a struct T.
template <class T>
struct BoundParameter {
  ParameterSpec spec;
  std::function<void(T&, const ParameterValue&)> set;
  std::function<ParameterValue(const T&)> get;
  bool T::*given_flag = nullptr;  ///< set if the user gave the parameter
  bool is_compared = true;        ///< two objects are equal only if this is equal
  double tolerance = 0.0;         ///< absolute, of that comparison; numbers only
  bool is_column = false;         ///< tables have a column of this name
  std::string column_default{};   ///< meaning of empty or absent cells; empty: not allowed

  BoundParameter& marks(bool T::*flag) { return given_flag = flag, *this; }
  BoundParameter& not_compared() { return is_compared = false, *this; }
  BoundParameter& compared_within(double allowed) { return tolerance = allowed, *this; }
  BoundParameter& column(const std::string& meaning_of_default = "") {
    is_column = true;
    column_default = meaning_of_default;
    return *this;
  }

  void give(T& object, const ParameterValue& value) const {
    set(object, value);
    if (given_flag != nullptr) object.*given_flag = true;
  }
  /// Reads the parameter from a validated list; false if the list lacks it, and the field stays as it is.
  bool read(const Teuchos::ParameterList& list, T& object) const {
    const Teuchos::ParameterEntry* entry = list.getEntryPtr(spec.name);
    if (entry == nullptr) return false;
    entry->isDefault() ? set(object, value_of(*entry)) : give(object, value_of(*entry));
    return true;
  }
  bool equal(const T& a, const T& b) const {
    if (spec.type != ParameterType::real || tolerance == 0.0) return get(a) == get(b);
    return std::abs(std::get<double>(get(a)) - std::get<double>(get(b))) <= tolerance;
  }
};

template <class T>
class BoundList {
 public:
  explicit BoundList(const std::string& meaning) : spec(meaning) {}

  ListSpec spec;  ///< unbound parameters and sublists are added here
  std::vector<BoundParameter<T>> parameters{};

  /// Binds a parameter to `field`: a member of T, or a function that finds the field in an object.
  template <class Field>
  BoundParameter<T>& bind(Field field, const ParameterSpec& parameter, const std::string& meaning) {
    return add({parameter.means(meaning),
                [field](T& object, const ParameterValue& v) { binding::assign(std::invoke(field, object), v); },
                [field](const T& object) { return binding::value_from(std::invoke(field, object)); }});
  }

  /// Binds words that denote values of any type.
  template <class Field>
  BoundParameter<T>& bind(
      Field field, ParameterSpec parameter, const std::string& meaning,
      const std::vector<std::pair<std::string, std::decay_t<std::invoke_result_t<Field, T&>>>>& words) {
    parameter.meaning = meaning;
    for (const auto& word : words) parameter.choices.push_back(word.first);
    const auto set = [field, words](T& object, const ParameterValue& value) {
      for (const auto& [word, held] : words)
        if (word == std::get<std::string>(value)) std::invoke(field, object) = held;
    };
    const auto get = [field, words](const T& object) {
      for (const auto& [word, held] : words)
        if (held == std::invoke(field, object)) return ParameterValue(word);
      return ParameterValue();
    };
    return add({std::move(parameter), set, get});
  }

  /// Binds a subset of words; the field has a flag for each.
  template <std::size_t n>
  BoundParameter<T>& bind(std::array<bool, n> T::*field, const ParameterSpec& parameter, const std::string& meaning) {
    const std::vector<std::string> words = parameter.choices;
    const auto set = [field, words](T& object, const ParameterValue& value) {
      const auto& given = std::get<Teuchos::Array<std::string>>(value);
      for (std::size_t i = 0; i < n; ++i)
        (object.*field)[i] = std::find(given.begin(), given.end(), words[i]) != given.end();
    };
    const auto get = [field, words](const T& object) {
      Teuchos::Array<std::string> held;
      for (std::size_t i = 0; i < n; ++i)
        if ((object.*field)[i]) held.push_back(words[i]);
      return ParameterValue(held);
    };
    return add({parameter.means(meaning), set, get});
  }

  /// Binds functions that set and get the field.
  BoundParameter<T>& bind_by(std::function<void(T&, const ParameterValue&)> set,
                             std::function<ParameterValue(const T&)> get, const ParameterSpec& parameter,
                             const std::string& meaning) {
    return add({parameter.means(meaning), std::move(set), std::move(get)});
  }

  /// Binds a sublist whose entries have names chosen by the user: each becomes an item {name, value}.
  template <class Item, class Value>
  void bind_named(std::vector<Item> T::*items, const std::string& name, const std::string& meaning,
                  const std::string& placeholder, const ParameterSpec& value, std::string Item::*key,
                  Value Item::*held) {
    spec.add_list(name, ListSpec(meaning).with_named_parameters(placeholder, value), Presence::optional);
    readers_.push_back([=](const Teuchos::ParameterList& list, T& object) {
      if (!list.isSublist(name)) return;
      const Teuchos::ParameterList& given = list.sublist(name);
      for (auto entry = given.begin(); entry != given.end(); ++entry) {
        Item& item = (object.*items).emplace_back();
        item.*key = given.name(entry);
        binding::assign(item.*held, value_of(given.entry(entry)));
      }
    });
  }

  /// Binds a sublist that fills a part of T; an optional part is filled only if the list is there.
  template <class Field, class Part>
  void bind_list(Field field, const std::string& name, const BoundList<Part>& part,
                 Presence presence = Presence::defaulted) {
    spec.add_list(name, part.spec, presence);
    readers_.push_back([field, name, part](const Teuchos::ParameterList& list, T& object) {
      if (list.isSublist(name)) part.read(list.sublist(name), binding::present(std::invoke(field, object)));
    });
  }

  /// Fills the fields from a validated list; fields of absent parameters stay as they are.
  void read(const Teuchos::ParameterList& list, T& object) const {
    for (const BoundParameter<T>& parameter : parameters) parameter.read(list, object);
    for (const auto& reader : readers_) reader(list, object);
  }
  T read(const Teuchos::ParameterList& list) const {
    T object;
    read(list, object);
    return object;
  }

  /// Name of the first compared parameter that differs; empty if none does.
  std::string difference(const T& a, const T& b) const {
    for (const BoundParameter<T>& parameter : parameters)
      if (parameter.is_compared && !parameter.equal(a, b)) return parameter.spec.name;
    return "";
  }

 private:
  BoundParameter<T>& add(BoundParameter<T> parameter) {
    ParameterSpec& declared = parameter.spec;
    if (declared.presence == Presence::defaulted && std::holds_alternative<std::monostate>(declared.default_value))
      declared.default_value = parameter.get(T{});
    spec.add(declared);
    parameters.push_back(std::move(parameter));
    return parameters.back();
  }

  std::vector<std::function<void(const Teuchos::ParameterList&, T&)>> readers_{};
};

}  // namespace mixbeam
