#include "discretization/parameters/parameter_file.hpp"

#include "discretization/parameters/value.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/tags.hpp"
#include "discretization/text/text_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <utility>

namespace mixbeam {
namespace {

constexpr std::size_t kLongestFlow = 110;  ///< columns that a list in one line may reach

template <class Held>
inline constexpr bool is_array_of_values =
    !std::is_arithmetic_v<Held> && !std::is_same_v<Held, std::string> && !std::is_same_v<Held, std::monostate>;

// XML

void write_xml(std::ostream& out, const Teuchos::ParameterList& list, const std::string& name, int depth) {
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  if (list.numParams() == 0) {
    out << indent << "<ParameterList name=\"" << xml_escaped(name) << "\"/>\n";
    return;
  }
  out << indent << "<ParameterList name=\"" << xml_escaped(name) << "\">\n";
  for (auto entry = list.begin(); entry != list.end(); ++entry) {
    const std::string& inner = list.name(entry);
    if (list.isSublist(inner)) {
      write_xml(out, list.sublist(inner), inner, depth + 1);
      continue;
    }
    const auto& [type, value] = written_value(list.entry(entry));
    out << indent << "  <Parameter name=\"" << xml_escaped(inner) << "\" type=\""
        << (type.empty() ? xml_name(static_cast<ParameterType>(value.index() - 1)) : type) << "\" value=\""
        << xml_escaped(attribute_text(value)) << "\"/>\n";
  }
  out << indent << "</ParameterList>\n";
}

// YAML

/// Whether every reader of YAML takes the unquoted text for this very text.
bool is_plain(const std::string& text) {
  static const std::set<std::string> kOtherThings = {"true", "false", "yes", "no", "y", "n", "on", "off", "null"};
  const auto is_harmless = [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string(" _/().*+^-").find(static_cast<char>(c)) != std::string::npos;
  };
  double number = 0.0;
  return !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0 && text.back() != ' ' &&
         std::all_of(text.begin(), text.end(), is_harmless) && kOtherThings.count(lower_case(text)) == 0 &&
         !parse_number(text, number).empty();
}

std::string yaml_scalar(const std::string& text) {
  if (is_plain(text)) return text;
  static const std::map<char, std::string> kEscapes = {
      {'\\', "\\\\"}, {'"', "\\\""}, {'\n', "\\n"}, {'\r', "\\r"}, {'\t', "\\t"}};
  std::string result = "\"";
  for (const char c : text) {
    const auto escape = kEscapes.find(c);
    result += escape == kEscapes.end() ? std::string(1, c) : escape->second;
  }
  return result + "\"";
}

std::string yaml_scalar(bool value) { return value ? "true" : "false"; }
std::string yaml_scalar(int value) { return std::to_string(value); }

/// `is_real`: declared as a real number, so that it needs no point. YAML 1.1 requires a point before an exponent.
std::string yaml_scalar(double value, bool is_real) {
  std::string text = shortest(value);
  if (!std::isfinite(value)) return is_real ? text : (value < 0.0 ? "-." : ".") + text.substr(value < 0.0 ? 1 : 0);
  const std::size_t exponent = text.find('e');
  const bool needs_point = exponent != std::string::npos || !is_real;
  if (needs_point && text.find('.') == std::string::npos) text.insert(std::min(exponent, text.size()), ".0");
  return text;
}

std::string yaml_value(const ParameterValue& value, const ParameterSpec* spec) {
  const bool is_real =
      spec != nullptr && (spec->type == ParameterType::real || spec->type == ParameterType::real_array);
  const bool is_partly_formula = spec != nullptr && stands_for_number(value, *spec);
  const auto scalar = [&](const auto& held) {
    using Held = std::decay_t<decltype(held)>;
    if constexpr (std::is_same_v<Held, double>) {
      return yaml_scalar(held, is_real);
    } else if constexpr (std::is_same_v<Held, std::string>) {
      double number = 0.0;
      return is_partly_formula && parse_number(held, number).empty() ? held : yaml_scalar(held);
    } else {
      return yaml_scalar(held);
    }
  };
  const auto text = [&scalar](const auto& held) -> std::string {
    using Held = std::decay_t<decltype(held)>;
    if constexpr (is_array_of_values<Held>) {
      std::string all;
      for (const auto& entry : held) all += (all.empty() ? "" : ", ") + scalar(entry);
      return "[" + all + "]";
    } else if constexpr (!std::is_same_v<Held, std::monostate>) {
      return scalar(held);
    }
    return "";
  };
  return std::visit(text, value);
}

/// Declaration of a list; null where nothing is declared.
struct Declared {
  const ListSpec* list;

  bool is_known() const { return list != nullptr && !list->unchecked; }
  Declared sublist(const std::string& name) const { return {is_known() ? list->list(name) : nullptr}; }
  const ParameterSpec* parameter(const std::string& name) const { return is_known() ? list->parameter(name) : nullptr; }
};

class YamlWriter {
 public:
  explicit YamlWriter(const std::vector<Comment>& comments) {
    for (const Comment& comment : comments) {
      comments_[{comment.path, comment.place}].push_back(comment.text);
      ParameterPath around = comment.path;
      if (comment.place == Comment::Place::end) commented_.insert(around);
      for (; !around.empty(); commented_.insert(around)) around.pop_back();
    }
  }

  std::string text(const XmlParameters& parameters, const ListSpec& spec, const std::string& file) {
    write_comments({}, Comment::Place::before, 0);
    const std::string& name = parameters.list->name();
    if (name != name_of_file(file)) out_ << kRootName << ": " << yaml_scalar(name) << "\n";
    write_entries(*parameters.list, {&spec}, {});
    if (parameters.list->numParams() == 0 && name == name_of_file(file)) out_ << "{}\n";
    return out_.str();
  }

 private:
  using List = Teuchos::ParameterList;

  /// Depth of lists that may stand in one line: entries named by the user, and lists in them.
  static constexpr std::size_t kFlowDepth = 3;

  void write_entries(const List& list, const Declared& declared, const ParameterPath& path) {
    const std::size_t indent = 2 * path.size();
    for (auto entry = list.begin(); entry != list.end(); ++entry) {
      const std::string& name = list.name(entry);
      const ParameterPath inner = child(path, name);
      write_comments(inner, Comment::Place::before, indent);
      out_ << std::string(indent, ' ') << yaml_scalar(name) << ":";
      if (list.isSublist(name)) {
        write_list(list.sublist(name), declared.sublist(name), inner, indent + yaml_scalar(name).size());
      } else {
        out_ << " " << yaml_value(value_of(list.entry(entry)), declared.parameter(name));
        write_comments_behind(inner);
      }
    }
    write_comments(path, Comment::Place::end, indent);
  }

  /// Writes a list behind its name, which ends in `column`.
  void write_list(const List& list, const Declared& declared, const ParameterPath& path, std::size_t column) {
    const bool may_flow = path.size() >= kFlowDepth && commented_.count(path) == 0;
    if (may_flow || list.numParams() == 0) {
      const std::string flow = flow_text(list, declared);
      if (flow.size() + column <= kLongestFlow || list.numParams() == 0) {
        out_ << " " << flow;
        write_comments_behind(path);
        return write_comments(path, Comment::Place::end, 2 * path.size());
      }
    }
    write_comments_behind(path);
    write_entries(list, declared, path);
  }

  static std::string flow_text(const List& list, const Declared& declared) {
    std::string text;
    for (auto entry = list.begin(); entry != list.end() && text.size() <= kLongestFlow; ++entry) {
      const std::string& name = list.name(entry);
      text += (text.empty() ? "" : ", ") + yaml_scalar(name) + ": ";
      text += list.isSublist(name) ? flow_text(list.sublist(name), declared.sublist(name))
                                   : yaml_value(value_of(list.entry(entry)), declared.parameter(name));
    }
    return "{" + text + "}";
  }

  void write_comments(const ParameterPath& path, Comment::Place place, std::size_t indent) {
    for (const std::string& comment : comments_[{path, place}]) {
      std::istringstream lines(comment);
      for (std::string line; std::getline(lines, line);)
        out_ << std::string(indent, ' ') << "#" << (trimmed(line).empty() ? "" : " ") << trimmed(line) << "\n";
    }
  }

  /// Writes the comments behind an entry and ends the line.
  void write_comments_behind(const ParameterPath& path) {
    std::string all;
    for (const std::string& comment : comments_[{path, Comment::Place::behind}]) all += " " + comment;
    std::replace(all.begin(), all.end(), '\n', ' ');
    out_ << (all.empty() ? "" : "  #" + all) << "\n";
  }

  std::ostringstream out_;
  std::map<std::pair<ParameterPath, Comment::Place>, std::vector<std::string>> comments_;
  std::set<ParameterPath> commented_;  ///< lists with a comment somewhere inside
};

}  // namespace

FileFormat format_of(const std::string& file, const std::string& text) {
  const std::string ending = lower_case(std::filesystem::path(file).extension().string());
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");       // the last three: a byte order mark
  if (first != std::string::npos && text[first] == '<') return FileFormat::xml;  // of Python, of a file in YAML
  if (ending == ".yaml" || ending == ".yml") return FileFormat::yaml;
  return ending == ".xml" || first == std::string::npos ? FileFormat::xml : FileFormat::yaml;
}

XmlParameters parse_parameters(const std::string& text, const std::string& file, const ListSpec& spec,
                               Mistakes mistakes) {
  return format_of(file, text) == FileFormat::yaml ? parse_yaml(text, file, spec, mistakes)
                                                   : parse_xml(text, file, mistakes);
}

XmlParameters read_parameters(const std::string& file, const ListSpec& spec, Mistakes mistakes) {
  return parse_parameters(text_of_file(file, "a scene in XML or YAML"), file, spec, mistakes);
}

std::string xml_text(const Teuchos::ParameterList& list) {
  std::ostringstream out;
  out << "<?xml version=\"1.0\"?>\n";
  write_xml(out, list, list.name(), 0);
  return out.str();
}

std::string yaml_text(const XmlParameters& parameters, const ListSpec& spec, const std::string& file) {
  return YamlWriter(parameters.comments).text(parameters, spec, file);
}

}  // namespace mixbeam
