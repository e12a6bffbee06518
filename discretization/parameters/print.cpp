#include "discretization/parameters/print.hpp"

#include <cctype>
#include <limits>
#include <sstream>

namespace mixbeam {
namespace {

constexpr std::size_t kColumns = 100;
constexpr int kIndent = 2;

/// Prints `text` broken at spaces; every line starts with `indent` spaces.
void print_wrapped(std::ostream& out, const std::string& text, int indent) {
  std::istringstream words(text);
  std::string line(static_cast<std::size_t>(indent), ' ');
  const std::size_t start = line.size();
  for (std::string word; words >> word;) {
    if (line.size() > start && line.size() + 1 + word.size() > kColumns) {
      out << line << '\n';
      line.resize(start);
    }
    line += (line.size() > start ? " " : "") + word;
  }
  if (line.size() > start) out << line << '\n';
}

/// Bounds that no scene reaches would only hide those that matter; messages of errors name them.
constexpr double kBeyondAnyScene = 1e99;

std::string described_values(ParameterSpec spec) {
  Range& range = spec.range;
  if (range.minimum <= -kBeyondAnyScene) range.minimum = -std::numeric_limits<double>::infinity();
  if (range.maximum >= kBeyondAnyScene) range.maximum = std::numeric_limits<double>::infinity();
  return allowed_values(spec);
}

/// Presence of a parameter without default, or of a list, whatever the defaults of its parameters.
std::string presence_text(Presence presence) { return presence == Presence::required ? "required" : "optional"; }

void print_parameter(std::ostream& out, const ParameterSpec& spec, const std::string& name, int indent) {
  std::string head = name + ": " + described_values(spec);
  head += spec.presence == Presence::defaulted ? "; default " + to_text(spec.default_value)
                                               : "; " + presence_text(spec.presence);
  print_wrapped(out, head, indent);
  print_wrapped(out, spec.meaning, indent + 2 * kIndent);
}

void print_list(std::ostream& out, const ListSpec& spec, const std::string& head, int indent) {
  if (!head.empty()) print_wrapped(out, head, indent);
  print_wrapped(out, spec.meaning, indent + 2 * kIndent);
  const int inside = head.empty() ? indent : indent + kIndent;
  for (const ParameterSpec& parameter : spec.parameters) print_parameter(out, parameter, parameter.name, inside);
  for (const SublistSpec& sublist : spec.sublists) {
    print_list(out, *sublist.list, "[" + sublist.name + "] " + presence_text(sublist.presence), inside);
  }
  const std::string placeholder = "<" + spec.placeholder + ">";
  const std::string many = spec.minimum_named > 0 ? " one or more" : " any number";
  if (spec.named_parameter) print_parameter(out, *spec.named_parameter, placeholder + many, inside);
  if (spec.named_list) print_list(out, *spec.named_list, "[" + placeholder + "]" + many, inside);
  if (spec.unchecked) print_wrapped(out, "(any parameters and lists)", inside);
}

/// Escapes a text for Markdown: no borders of cells, no tags.
std::string shown(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool tag =
        text[i] == '<' && i + 1 < text.size() && std::isalpha(static_cast<unsigned char>(text[i + 1])) != 0;
    if (text[i] == '|' || text[i] == '*' || tag) result += '\\';
    result += text[i] == '\n' ? ' ' : text[i];
  }
  return result;
}

/// Anchor that GitHub gives the heading `text`.
std::string anchor(const std::string& text) {
  std::string result = "#";
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) result += static_cast<char>(std::tolower(c));
    if (c == ' ') result += '-';
  }
  return result;
}

void print_row(std::ostream& out, const std::string& name, const ParameterSpec& spec) {
  const bool defaulted = spec.presence == Presence::defaulted;
  out << "| " << shown(name) << " | " << shown(described_values(spec)) << " | "
      << shown(defaulted ? to_text(spec.default_value) : presence_text(spec.presence)) << " | " << shown(spec.meaning)
      << " |\n";
}

std::string sentence(std::string words) {
  words[0] = static_cast<char>(std::toupper(words[0]));
  return words + ". ";
}

void print_markdown_list(std::ostream& out, const ListSpec& spec, const std::string& path, const std::string& presence);

/// Lists inside `spec`, each with its heading; `path` are the lists around them.
void print_markdown_sublists(std::ostream& out, const ListSpec& spec, const std::string& path) {
  const std::string before = path.empty() ? "" : path + " / ";
  for (const SublistSpec& sublist : spec.sublists)
    print_markdown_list(out, *sublist.list, before + sublist.name, presence_text(sublist.presence));
  if (spec.named_list)
    print_markdown_list(out, *spec.named_list, before + "<" + spec.placeholder + ">",
                        spec.minimum_named > 0 ? "one or more" : "any number");
}

void print_markdown_list(std::ostream& out, const ListSpec& spec, const std::string& path,
                         const std::string& presence) {
  out << (path.find(" / ") == std::string::npos ? "\n## " : "\n### ") << shown(path) << "\n\n"
      << sentence(presence) << shown(spec.meaning) << "\n";
  if (!spec.parameters.empty() || spec.named_parameter) {
    out << "\n| parameter | type and range | default | meaning |\n| --- | --- | --- | --- |\n";
    for (const ParameterSpec& parameter : spec.parameters) print_row(out, parameter.name, parameter);
    const std::string many = spec.minimum_named > 0 ? ", one or more" : ", any number";
    if (spec.named_parameter) print_row(out, "<" + spec.placeholder + ">" + many, *spec.named_parameter);
  }
  if (spec.unchecked) out << "\nAny parameters and lists.\n";
  print_markdown_sublists(out, spec, path);
}

/// One line for each list: links to it and to the lists in it.
void print_markdown_contents(std::ostream& out, const ListSpec& spec) {
  for (const SublistSpec& sublist : spec.sublists) {
    out << "- [" << sublist.name << "](" << anchor(sublist.name) << ")";
    const char* separator = ": ";
    for (const SublistSpec& inner : sublist.list->sublists) {
      out << separator << "[" << inner.name << "](" << anchor(sublist.name + " / " + inner.name) << ")";
      separator = ", ";
    }
    out << "\n";
  }
}

}  // namespace

void print_parameters(std::ostream& out, const ListSpec& spec, const std::string& name) {
  print_list(out, spec, name.empty() ? "" : "[" + name + "]", 0);
}

void print_parameters_markdown(std::ostream& out, const ListSpec& spec, const std::string& title,
                               const std::string& introduction) {
  out << "# " << title << "\n\n" << introduction << "\n\n";
  print_markdown_contents(out, spec);
  print_markdown_sublists(out, spec, "");
}

}  // namespace mixbeam
