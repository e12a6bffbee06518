#include "discretization/parameters/print.hpp"

#include <libxml/parser.h>
#include <libxml/tree.h>

#include <cmath>
#include <memory>
#include <vector>

namespace mixbeam {
namespace {

/// A finite number as parse_number takes it.
const std::string kNumber = R"([+\-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]+)?)";
const std::string kInfinity = "inf";

/// Adds elements of a schema below `parent`.
xmlNodePtr add(xmlNodePtr parent, const char* tag) { return xmlNewChild(parent, nullptr, BAD_CAST tag, nullptr); }
xmlNodePtr add_text(xmlNodePtr parent, const char* tag, const std::string& text) {
  return xmlNewTextChild(parent, nullptr, BAD_CAST tag, BAD_CAST text.c_str());
}
xmlNodePtr with(xmlNodePtr node, const char* attribute, const std::string& value) {
  xmlSetProp(node, BAD_CAST attribute, BAD_CAST value.c_str());
  return node;
}

xmlNodePtr add_data(xmlNodePtr parent, const char* type) { return with(add(parent, "data"), "type", type); }
xmlNodePtr add_attribute(xmlNodePtr parent, const char* name) { return with(add(parent, "attribute"), "name", name); }
void add_param(xmlNodePtr data, const char* name, const std::string& value) {
  with(add_text(data, "param", value), "name", name);
}
void add_pattern(xmlNodePtr parent, const std::string& pattern) {
  add_param(add_data(parent, "string"), "pattern", pattern);
}
void add_word(xmlNodePtr parent, const std::string& word) { with(add_text(parent, "value", word), "type", "string"); }
void add_words(xmlNodePtr parent, const std::vector<std::string>& words) {
  xmlNodePtr choice = add(parent, "choice");
  for (const std::string& word : words) add_word(choice, word);
}

/// Pattern of an array in braces: `length` times `one`; 0: any number.
std::string array_pattern(const std::string& one, int length, bool empty_allowed) {
  const std::string repeated = "(\\s*,\\s*" + one + ")" + (length > 0 ? "{" + std::to_string(length - 1) + "}" : "*");
  const std::string entries = one + repeated + "\\s*";
  return "\\s*\\{\\s*" + (empty_allowed && length == 0 ? "(" + entries + ")?" : entries) + "\\}\\s*";
}

std::string pattern_of_words(const std::vector<std::string>& words) {
  std::string pattern;
  for (const std::string& word : words) {
    pattern += pattern.empty() ? "(" : "|";
    for (const char c : word)
      pattern += (std::string(R"(\.[]{}()*+?^|-)").find(c) == std::string::npos ? "" : "\\") + std::string(1, c);
  }
  return pattern + ")";
}

void add_range(xmlNodePtr data, const Range& range, bool is_whole) {
  const auto bound = [is_whole](double value) {
    return is_whole ? std::to_string(static_cast<long long>(value)) : shortest(value);
  };
  const bool fits = !is_whole || (std::abs(range.minimum) < 1e9 && std::abs(range.maximum) < 1e9);
  if (std::isfinite(range.minimum) && fits)
    add_param(data, range.minimum_excluded ? "minExclusive" : "minInclusive", bound(range.minimum));
  if (std::isfinite(range.maximum) && fits)
    add_param(data, range.maximum_excluded ? "maxExclusive" : "maxInclusive", bound(range.maximum));
}

void add_value(xmlNodePtr parent, const ParameterSpec& spec, ParameterType type) {
  const std::string number = spec.range.infinity_allowed ? "(" + kNumber + "|" + kInfinity + ")" : kNumber;
  switch (type) {
    case ParameterType::boolean:
      add_pattern(parent, R"(\s*(true|false)\s*)");
      return;
    case ParameterType::integer:
      add_range(add_data(parent, "int"), spec.range, true);
      return;
    case ParameterType::real: {
      xmlNodePtr choice = spec.range.infinity_allowed ? add(parent, "choice") : parent;
      xmlNodePtr data = add_data(choice, "double");
      add_param(data, "pattern", kNumber);
      add_range(data, spec.range, false);
      if (spec.range.infinity_allowed) add_word(choice, kInfinity);
      return;
    }
    case ParameterType::text:
      if (spec.choices.empty() || !spec.other_words.empty())
        add_data(parent, "string");
      else
        add_words(parent, spec.choices);
      return;
    case ParameterType::integer_array:
      add_pattern(parent, array_pattern(R"([+\-]?[0-9]+)", spec.length, spec.empty_allowed));
      return;
    case ParameterType::real_array:
      add_pattern(parent, array_pattern(number, spec.length, spec.empty_allowed));
      return;
    case ParameterType::text_array:  // a comma in parentheses belongs to a formula, so they cannot be counted
      if (!spec.choices.empty())
        add_pattern(parent, array_pattern(pattern_of_words(spec.choices), 0, true));
      else
        add_pattern(parent, spec.empty_allowed ? R"(\s*\{[^\{]*\}\s*)" : R"(\s*\{[^\{]*\S[^\{]*\}\s*)");
      return;
  }
}

/// Adds attributes "type" and "value" that match each other.
void add_typed_value(xmlNodePtr choice, const ParameterSpec& spec, ParameterType type) {
  xmlNodePtr group = add(choice, "group");
  add_word(add_attribute(group, "type"), xml_name(type));
  add_value(add_attribute(group, "value"), spec, type);
}

/// Allows a formula in place of a number, or an array with some.
void add_formula(xmlNodePtr choice, const ParameterSpec& spec) {
  const bool numbers = spec.type == ParameterType::integer_array || spec.type == ParameterType::real_array;
  if (!numbers && spec.type != ParameterType::integer && spec.type != ParameterType::real) return;
  std::vector<std::string> types = {xml_name(spec.type), numbers ? "Array(string)" : "string"};
  if (spec.type == ParameterType::real) types.push_back("int");
  if (spec.type == ParameterType::real_array) types.push_back("Array(int)");
  xmlNodePtr group = add(choice, "group");
  add_words(add_attribute(group, "type"), types);
  add_pattern(add_attribute(group, "value"), numbers ? R"(\s*\{[^\{]*=[^\{]*\}\s*)" : R"(\s*=[\s\S]*)");
  if (!spec.other_words.empty()) add_typed_value(choice, ParameterSpec(), ParameterType::text);
}

/// Adds an element that may have the attributes that Teuchos writes.
xmlNodePtr add_element(xmlNodePtr parent, const char* tag) {
  xmlNodePtr element = with(add(parent, "element"), "name", tag);
  with(add(element, "ref"), "name", "other");
  return element;
}

/// Adds an element with any name but those of `spec`.
xmlNodePtr add_free(xmlNodePtr parent, const char* tag, const ListSpec& spec) {
  xmlNodePtr element = add_element(parent, tag), data = add_data(add_attribute(element, "name"), "string");
  add_param(data, "pattern", R"([\s\S]*\S[\s\S]*)");
  if (!spec.fixed_names().empty()) add_words(add(data, "except"), spec.fixed_names());
  return element;
}

xmlNodePtr add_named(xmlNodePtr parent, const char* tag, const std::string& name) {
  xmlNodePtr element = add_element(parent, tag);
  add_word(add_attribute(element, "name"), name);
  return element;
}

/// Adds text that editors show.
void add_documentation(xmlNodePtr element, const std::string& text) { add_text(element, "a:documentation", text); }

/// Adds the content of an element that has its name already.
void add_parameter(xmlNodePtr element, const ParameterSpec& spec) {
  add_documentation(element, spec.meaning + " (" + allowed_values(spec) + ")");
  xmlNodePtr choice = add(element, "choice");
  add_typed_value(choice, spec, spec.type);
  if (spec.type == ParameterType::real) add_typed_value(choice, spec, ParameterType::integer);
  if (spec.type == ParameterType::real_array) add_typed_value(choice, spec, ParameterType::integer_array);
  add_formula(choice, spec);
  if (spec.words.empty()) return;
  for (const char* type : {"string", "bool"}) {
    xmlNodePtr group = add(choice, "group");
    add_word(add_attribute(group, "type"), type);
    add_words(add_attribute(group, "value"), spec.words);
  }
}

/// Parameters of any type, for lists and names without declaration.
void add_any_parameter(xmlNodePtr element) {
  xmlNodePtr choice = add(element, "choice");
  const ParameterSpec anything = ParameterSpec().or_infinite().or_empty();
  for (std::size_t i = 0; i < xml_names().size(); ++i) add_typed_value(choice, anything, static_cast<ParameterType>(i));
}

void add_list(xmlNodePtr element, const ListSpec& spec) {
  add_documentation(element, spec.meaning);
  if (spec.unchecked) return static_cast<void>(with(add(element, "ref"), "name", "anything"));
  xmlNodePtr choice = add(add(element, "zeroOrMore"), "choice");
  for (const ParameterSpec& parameter : spec.parameters)
    add_parameter(add_named(choice, "Parameter", parameter.name), parameter);
  for (const std::string& name : spec.removed) add_any_parameter(add_named(choice, "Parameter", name));
  for (const SublistSpec& sublist : spec.sublists)
    add_list(add_named(choice, "ParameterList", sublist.name), *sublist.list);
  if (spec.named_parameter) add_parameter(add_free(choice, "Parameter", spec), *spec.named_parameter);
  if (spec.named_list) add_list(add_free(choice, "ParameterList", spec), *spec.named_list);
  if (choice->children == nullptr) add(choice, "notAllowed");
}

void add_definitions(xmlNodePtr grammar) {
  xmlNodePtr others = with(add(grammar, "define"), "name", "other");
  for (const char* name : {"id", "docString", "isDefault", "isUsed"})
    add_data(add_attribute(add(others, "optional"), name), "string");
  xmlNodePtr anything = with(add(grammar, "define"), "name", "anything");
  xmlNodePtr choice = add(add(anything, "zeroOrMore"), "choice");
  with(add(add_free(choice, "ParameterList", {}), "ref"), "name", "anything");
  add_any_parameter(add_free(choice, "Parameter", {}));
}

}  // namespace

void print_relax_ng(std::ostream& out, const ListSpec& spec) {
  const std::unique_ptr<xmlDoc, void (*)(xmlDocPtr)> document(xmlNewDoc(BAD_CAST "1.0"), xmlFreeDoc);
  xmlNodePtr grammar = xmlNewNode(nullptr, BAD_CAST "grammar");
  xmlDocSetRootElement(document.get(), grammar);
  with(grammar, "xmlns", "http://relaxng.org/ns/structure/1.0");
  with(grammar, "xmlns:a", "http://relaxng.org/ns/compatibility/annotations/1.0");
  with(grammar, "datatypeLibrary", "http://www.w3.org/2001/XMLSchema-datatypes");
  xmlNodePtr root = add_element(add(grammar, "start"), "ParameterList");
  add_data(add_attribute(add(root, "optional"), "name"), "string");
  add_list(root, spec);
  add_definitions(grammar);
  xmlChar* text = nullptr;
  int size = 0;
  xmlDocDumpFormatMemoryEnc(document.get(), &text, &size, "UTF-8", 1);
  out.write(reinterpret_cast<const char*>(text), size);
  xmlFree(text);
}

}  // namespace mixbeam
