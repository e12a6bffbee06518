#include "discretization/print_parameters.hpp"

#include <sstream>

namespace mixbeam {
namespace {

constexpr std::size_t kColumns = 100;
constexpr int kIndent = 2;

/// `text` broken at spaces; every line starts with `indent` spaces.
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

std::string presence_text(Presence presence) {
  switch (presence) {
    case Presence::required:
      return "required";
    case Presence::optional:
      return "optional";
    case Presence::defaulted:
      break;
  }
  return "";
}

void print_parameter(std::ostream& out, const ParameterSpec& spec, const std::string& name, int indent) {
  std::string head = name + ": " + allowed_values(spec);
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
    const std::string presence = presence_text(sublist.presence);
    print_list(out, *sublist.list, "[" + sublist.name + "]" + (presence.empty() ? "" : " " + presence), inside);
  }
  const std::string placeholder = "<" + spec.placeholder + ">";
  const std::string many = spec.minimum_named > 0 ? " one or more" : " any number";
  if (spec.named_parameter) print_parameter(out, *spec.named_parameter, placeholder + many, inside);
  if (spec.named_list) print_list(out, *spec.named_list, "[" + placeholder + "]" + many, inside);
  if (spec.unchecked) print_wrapped(out, "(any parameters and lists)", inside);
}

}  // namespace

void print_parameters(std::ostream& out, const ListSpec& spec, const std::string& name) {
  print_list(out, spec, name.empty() ? "" : "[" + name + "]", 0);
}

namespace {

/// Text for a cell of a table.
std::string cell(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '|' ? "\\|" : c == '<' ? "&lt;" : c == '\n' ? " " : std::string(1, c);
  return result;
}

std::string presence_or_default(const ParameterSpec& spec) {
  return spec.presence == Presence::defaulted ? to_text(spec.default_value) : presence_text(spec.presence);
}

void print_row(std::ostream& out, const std::string& name, const ParameterSpec& spec) {
  out << "| " << cell(name) << " | " << cell(allowed_values(spec)) << " | " << cell(presence_or_default(spec)) << " | "
      << cell(spec.meaning) << " |\n";
}

void print_markdown_list(std::ostream& out, const ListSpec& spec, const std::string& path);

void print_markdown_sublists(std::ostream& out, const ListSpec& spec, const std::string& path) {
  const std::string before = path.empty() ? "" : path + " / ";
  for (const SublistSpec& sublist : spec.sublists) {
    const std::string presence = presence_text(sublist.presence);
    out << "\n## " << cell(before + sublist.name) << (presence.empty() ? "" : " (" + presence + ")") << "\n\n";
    print_markdown_list(out, *sublist.list, before + sublist.name);
  }
  if (!spec.named_list) return;
  const std::string many = spec.minimum_named > 0 ? " (one or more)" : " (any number)";
  out << "\n## " << cell(before + "<" + spec.placeholder + ">") << many << "\n\n";
  print_markdown_list(out, *spec.named_list, before + "<" + spec.placeholder + ">");
}

void print_markdown_list(std::ostream& out, const ListSpec& spec, const std::string& path) {
  out << cell(spec.meaning) << "\n";
  if (!spec.parameters.empty() || spec.named_parameter) {
    out << "\n| parameter | type and range | default | meaning |\n| --- | --- | --- | --- |\n";
    for (const ParameterSpec& parameter : spec.parameters) print_row(out, parameter.name, parameter);
    const std::string many = spec.minimum_named > 0 ? ", one or more" : ", any number";
    if (spec.named_parameter) print_row(out, "<" + spec.placeholder + ">" + many, *spec.named_parameter);
  }
  if (spec.unchecked) out << "\nAny parameters and lists.\n";
  print_markdown_sublists(out, spec, path);
}

}  // namespace

void print_parameters_markdown(std::ostream& out, const ListSpec& spec, const std::string& title) {
  out << "# " << title << "\n\n";
  print_markdown_list(out, spec, "");
}

}  // namespace mixbeam
