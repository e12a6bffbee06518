#include "discretization/parameters/parameter_file.hpp"

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/text/message_text.hpp"

#include <libxml/xmlstring.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>

namespace mixbeam {
namespace {

/// Nodes that aliases may add: a real file repeats a few lists, a bomb repeats repetitions.
constexpr std::size_t kMostAliasNodes = 100'000;

/// A scalar, sequence or map. The children of a map are its keys and values in turn.
struct YamlNode {
  enum class Kind { plain, quoted, sequence, map };
  Kind kind = Kind::plain;
  bool is_absent = false;  ///< no value was written
  YAML::Mark mark{};
  std::string text{};
  std::vector<std::size_t> children{};
};

std::string described(YamlNode::Kind kind) {
  return kind == YamlNode::Kind::map ? "a map" : kind == YamlNode::Kind::sequence ? "a sequence" : "a value";
}

const std::string kNothingAfter = "; nothing after this line was read";

/// Name and text of a file.
struct YamlFile {
  const std::string& name;
  const std::string& text;

  InputError error(int line, int column, const std::string& problem) const {
    return InputError(name + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + problem +
                      marked_line(text, offset_of(text, line, column)));
  }
  InputError error(const YAML::Mark& mark, const std::string& problem) const {
    return error(mark.line + 1, mark.column + 1, problem);
  }
};

/// Keeps the nodes that the parser's events describe. An alias adds a parent to its node.
class YamlTree : public YAML::EventHandler {
 public:
  explicit YamlTree(const YamlFile& file) : file_(file) {}

  const YamlNode& operator[](std::size_t node) const { return nodes_[node]; }
  std::size_t size() const { return nodes_.size(); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (!nodes_.empty()) throw file_.error(mark, "a second document; allowed: one");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    YamlNode& node = add(YamlNode::Kind::plain, mark, "?", anchor);
    node.text = null_word(mark);
    node.is_absent = node.text.empty();
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (open_.empty()) throw file_.error(mark, "an alias without anything around it");
    nodes_[open_.back()].children.push_back(anchors_.at(anchor));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const bool is_text = tag == "!" || tag == "tag:yaml.org,2002:str";
    const auto is_control = [](unsigned char c) { return c < ' ' && c != '\t' && c != '\n' && c != '\r'; };
    if (std::any_of(value.begin(), value.end(), is_control))
      throw file_.error(mark, "\"" + excerpt(value) + "\" holds a control character; allowed: text");
    if (is_open_quote(static_cast<std::size_t>(mark.pos)))
      throw file_.error(mark, "not well-formed YAML: a quote that is not closed in this line" + kNothingAfter);
    add(is_text ? YamlNode::Kind::quoted : YamlNode::Kind::plain, mark, is_text ? "!" : tag, anchor).text = value;
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    open(YamlNode::Kind::sequence, mark, tag, anchor);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    open(YamlNode::Kind::map, mark, tag, anchor);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  YamlNode& add(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    if (tag != "?" && tag != "!" && !tag.empty())
      throw file_.error(mark, "tag \"" + excerpt(tag) + "\"; allowed: !!str for text, types follow from the names");
    // The parser places an absent value at the next token, which may be the word null.
    if (!nodes_.empty() && nodes_.back().kind == YamlNode::Kind::plain && nodes_.back().mark.pos == mark.pos) {
      nodes_.back().text.clear();
      nodes_.back().is_absent = true;
    }
    const std::size_t index = nodes_.size();
    if (anchor != 0) anchors_[anchor] = index;
    if (!open_.empty()) nodes_[open_.back()].children.push_back(index);
    nodes_.push_back({kind, false, mark, {}, {}});
    return nodes_.back();
  }
  void open(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    if (open_.size() >= kDeepestLists)
      throw file_.error(mark, "lists nested deeper than " + std::to_string(kDeepestLists));
    add(kind, mark, tag, anchor);
    open_.push_back(nodes_.size() - 1);
  }
  /// Whether the quote at `at` is not closed: the parser ends it with the file.
  bool is_open_quote(std::size_t at) const {
    const char quote = at < file_.text.size() ? file_.text[at] : ' ';
    if (quote != '"' && quote != '\'') return false;
    while (++at < file_.text.size() && file_.text[at] != quote)
      if (quote == '"' && file_.text[at] == '\\') ++at;
    return at >= file_.text.size();
  }
  /// Spelling of a null scalar, which the parser does not report and which matters if it is a name.
  std::string null_word(const YAML::Mark& mark) const {
    for (const char* word : {"null", "Null", "NULL", "~"})
      if (file_.text.compare(static_cast<std::size_t>(mark.pos), std::string(word).size(), word) == 0) return word;
    return "";
  }

  const YamlFile file_;
  std::vector<YamlNode> nodes_;    ///< the root is the first
  std::vector<std::size_t> open_;  ///< sequences and maps that have not ended
  std::map<YAML::anchor_t, std::size_t> anchors_;
};

Problem parse_plain(const std::string& text, bool& value) {
  value = text == "true" || text == "True" || text == "TRUE";
  return value || text == "false" || text == "False" || text == "FALSE" ? "" : "no switch";
}
Problem parse_plain(const std::string& text, int& value) { return parse_number(text, value); }
/// Accepts .inf, as YAML writes it, besides inf.
Problem parse_plain(const std::string& text, double& value) {
  const std::size_t sign = text.find_first_not_of("+-") == 1 ? 1 : 0;
  const bool is_infinite = lower_case(text.substr(sign)) == ".inf";
  return parse_number(is_infinite ? text.substr(0, sign) + "inf" : text, value);
}

/// Fills a list from a tree.
class YamlFiller {
 public:
  YamlFiller(const YamlTree& tree, const YamlFile& file, XmlParameters& result)
      : tree_(tree), file_(file), result_(result) {}

  void fill_root(const ListSpec& spec) {
    if (tree_[0].kind != YamlNode::Kind::map)
      throw file_.error(tree_[0].mark, described(tree_[0].kind) + "; allowed: lists by their names, like \"Scene:\"");
    result_.source.record({}, tree_[0].mark.line + 1, tree_[0].mark.column + 1);
    fill(*result_.list, &spec, tree_[0]);
  }

 private:
  using Kind = YamlNode::Kind;

  InputError error(const YamlNode& node, const std::string& problem) const {
    const std::string place = path_.empty() ? "" : "YAML path \"" + mixbeam::to_string(path_) + "\": ";
    return file_.error(node.mark, place + problem);
  }

  /// `entry`: number of keys and values of the map before the node.
  InputError missing_value(const YamlNode& node, std::size_t entry = 0) const {
    double number = 0.0;
    const bool follows_a_comma = entry > 0 && parse_plain(node.text, number).empty();
    return error(node, "no value; allowed: a colon, a blank and a value, \"\" for an empty text, {} for an empty list" +
                           (follows_a_comma ? "; decimals have a point: a comma separates entries" : hint_));
  }

  /// `spec`: null where nothing is declared.
  void fill(Teuchos::ParameterList& list, const ListSpec* spec, const YamlNode& map) {
    if (path_.size() > kDeepestLists)
      throw error(map, "lists nested deeper than " + std::to_string(kDeepestLists) + " by an alias");
    for (std::size_t i = 0; i + 1 < map.children.size(); i += 2) {
      const YamlNode& key = tree_[map.children[i]];
      const YamlNode& value = tree_[map.children[i + 1]];
      count_nodes(key);
      const ParameterPath around = path_;
      result_.source.attempt([&] { path_.push_back(name_of(key)); });
      if (path_.size() > around.size())
        InputPlace(result_.source, path_).attempt([&] {
          result_.source.record(path_, key.mark.line + 1, key.mark.column + 1);
          if (value.is_absent) throw missing_value(key, i);
          take(list, spec, value);
        });
      path_ = around;
      if (visited_ > most_nodes()) result_.source.require_none();
    }
  }

  const std::string& name_of(const YamlNode& key) const {
    if (key.kind != Kind::plain && key.kind != Kind::quoted)
      throw error(key, described(key.kind) + " as a name; allowed: text");
    if (key.kind == Kind::plain && key.text == "<<")
      throw error(key, "a merge key (<<); allowed: each list in full, or an alias of a whole list");
    if (trimmed(key.text).empty()) throw error(key, "an empty name");
    return key.text;
  }

  void take(Teuchos::ParameterList& list, const ListSpec* spec, const YamlNode& value) {
    const std::string name = path_.back();
    const bool is_declared = spec != nullptr && !spec->unchecked;
    if (value.kind == Kind::map) {
      const ListSpec* inner = is_declared ? spec->list(name) : nullptr;
      const ParameterSpec* parameter = is_declared ? spec->parameter(name) : nullptr;
      hint_ = parameter != nullptr && is_array(parameter->type) ? "; did you mean a sequence, like [1, 2, 3]?" : "";
      return fill(list.sublist(name), inner, value);
    }
    if (path_.size() == 1 && name == kRootName && value.kind != Kind::sequence) {
      const std::string& root = entries_of(value)[0]->text;
      list.setName(root);
      return result_.source.set_root_name(root);
    }
    const ParameterSpec* declared = is_declared ? spec->parameter(name) : nullptr;
    const ParameterValue read = value_of(value, declared);
    set_value(list, name, read);
    if (declared != nullptr && holds_formula(read) && stands_for_number(read, *declared))
      list.getEntry(name).setDocString(xml_name(declared->type));
  }

  ParameterValue value_of(const YamlNode& node, const ParameterSpec* spec) {
    const std::vector<const YamlNode*> entries = entries_of(node);
    const bool is_array = node.kind == Kind::sequence;
    ParameterValue value;
    if (spec != nullptr && parse(entries, is_array, spec->type, value)) return value;
    for (const ParameterType type : {ParameterType::boolean, ParameterType::integer, ParameterType::real,
                                     ParameterType::integer_array, ParameterType::real_array})
      if (!(is_array && entries.empty()) && parse(entries, is_array, type, value)) return value;
    parse(entries, is_array, is_array ? ParameterType::text_array : ParameterType::text, value);
    return value;
  }

  /// The scalar itself, or the scalars of a sequence.
  std::vector<const YamlNode*> entries_of(const YamlNode& node) {
    std::vector<const YamlNode*> entries;
    if (node.kind != Kind::sequence) entries.push_back(&node);
    for (const std::size_t child : node.children) entries.push_back(&tree_[child]);
    for (const YamlNode* entry : entries) {
      count_nodes(*entry);
      if (entry->is_absent) throw missing_value(*entry);
      if (entry->kind == Kind::map || entry->kind == Kind::sequence)
        throw error(*entry, described(entry->kind) + " in a sequence; allowed: values between commas, like [1, 2, 3]");
    }
    return entries;
  }

  /// False if an entry does not have the type.
  static bool parse(const std::vector<const YamlNode*>& entries, bool is_array, ParameterType type,
                    ParameterValue& value) {
    using Parse = bool (*)(const std::vector<const YamlNode*>&, ParameterValue&);
    static constexpr Parse kByType[] = {parse_one<bool>,        parse_one<int>, parse_one<double>,
                                        parse_one<std::string>, parse_all<int>, parse_all<double>,
                                        parse_all<std::string>};
    return is_array == mixbeam::is_array(type) && kByType[static_cast<std::size_t>(type)](entries, value);
  }

  template <class T>
  static bool read_scalar(const YamlNode& node, T& value) {
    if constexpr (std::is_same_v<T, std::string>) {
      value = node.text;
      return true;
    } else {
      return node.kind == Kind::plain && parse_plain(node.text, value).empty();
    }
  }
  template <class T>
  static bool parse_one(const std::vector<const YamlNode*>& entries, ParameterValue& value) {
    return read_scalar(*entries[0], value.emplace<T>());
  }
  template <class T>
  static bool parse_all(const std::vector<const YamlNode*>& entries, ParameterValue& value) {
    Teuchos::Array<T>& all = value.emplace<Teuchos::Array<T>>();
    for (const YamlNode* entry : entries) {
      T one{};
      if (!read_scalar(*entry, one)) return false;
      all.push_back(one);
    }
    return true;
  }

  std::size_t most_nodes() const { return tree_.size() + kMostAliasNodes; }
  void count_nodes(const YamlNode& node) {
    if (++visited_ <= most_nodes()) return;
    throw error(node, "aliases unfold to more than " + std::to_string(kMostAliasNodes) + " entries");
  }

  const YamlTree& tree_;
  const YamlFile file_;
  XmlParameters& result_;
  ParameterPath path_;
  std::string hint_;  ///< for values absent in the list being filled
  std::size_t visited_ = 0;
};

/// First line that is not text in UTF-8; 0 if there is none.
int line_without_text(const std::string& text) {
  int number = 1;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line); ++number) {
    const auto is_control = [](unsigned char c) { return c < ' ' && c != '\t' && c != '\r'; };
    if (std::any_of(line.begin(), line.end(), is_control)) return number;
    if (xmlCheckUTF8(reinterpret_cast<const xmlChar*>(line.c_str())) == 0) return number;
  }
  return 0;
}

/// Line and column, from 1, of the first tab in the indentation of a line up to `last_line`; zeros if there is none.
std::pair<int, int> place_of_tab(const std::string& text, int last_line) {
  int number = 1;
  std::istringstream lines(text);
  for (std::string line; number <= last_line && std::getline(lines, line); ++number) {
    const std::size_t first = line.find_first_not_of(' ');
    if (first != std::string::npos && line[first] == '\t') return {number, static_cast<int>(first) + 1};
  }
  return {};
}

/// Place of the last quote in the first line, up to `last_line`, with an odd number of them before its comment.
std::pair<int, int> place_of_open_quote(const std::string& text, int last_line) {
  int number = 1;
  std::istringstream lines(text);
  for (std::string line; number <= last_line && std::getline(lines, line); ++number) {
    line.resize(std::min({line.size(), line.find(" #"), line.rfind('#', 0)}));
    if (std::count(line.begin(), line.end(), '"') % 2 == 1) return {number, static_cast<int>(line.rfind('"')) + 1};
  }
  return {};
}

/// Message of the parser, with a hint at the usual cause.
InputError syntax_error(const YAML::ParserException& problem, const YamlFile& file) {
  using namespace YAML::ErrorMsg;
  const auto is_one_of = [&](std::initializer_list<const char*> messages) {
    return std::any_of(messages.begin(), messages.end(), [&](const char* text) { return problem.msg == text; });
  };
  const std::string kind = "not well-formed YAML: ";
  if (const auto [line, column] = place_of_tab(file.text, problem.mark.line + 1); line > 0)
    return file.error(
        line, column,
        kind + "a tab in the indentation; allowed: spaces, as many for each entry of a map" + kNothingAfter);
  if (const auto [line, column] = place_of_open_quote(file.text, problem.mark.line + 1); line > 0)
    return file.error(line, column, kind + "a quote that is not closed in this line" + kNothingAfter);
  std::string hint;
  if (is_one_of({ALIAS_NOT_FOUND, CHAR_IN_ALIAS, UNKNOWN_ANCHOR}))
    hint = "; a pattern that begins with * stands in quotes, like \"*\"";
  else if (is_one_of({END_OF_MAP, END_OF_SEQ, BLOCK_ENTRY, MAP_KEY}))
    hint = "; all entries of a map have the same indentation, and a colon and a blank behind their names";
  else if (is_one_of({END_OF_MAP_FLOW, END_OF_SEQ_FLOW, FLOW_END}))
    hint = "; a comma or a closing bracket is missing before this place, or one is too many";
  else if (is_one_of({MAP_VALUE}))
    hint =
        "; a text with a colon in it stands in quotes, and behind the colon of a name, here or in the line before, "
        "comes a blank";
  if (problem.mark.line < 0) return InputError(file.name + ": " + kind + excerpt(problem.msg) + hint);
  return file.error(problem.mark, kind + excerpt(problem.msg) + hint + kNothingAfter);
}

}  // namespace

XmlParameters parse_yaml(const std::string& text, const std::string& file, const ListSpec& spec, Mistakes mistakes) {
  const std::string byte_order_mark = "\xEF\xBB\xBF";
  const bool is_marked = text.compare(0, byte_order_mark.size(), byte_order_mark) == 0;
  const std::string plain = is_marked ? text.substr(byte_order_mark.size()) : text;
  if (const int line = line_without_text(plain); line > 0)
    throw InputError(file + ":" + std::to_string(line) + ": not a text in UTF-8 without control characters");
  XmlParameters result{Teuchos::rcp(new Teuchos::ParameterList(name_of_file(file))),
                       ParameterSource(file, name_of_file(file)),
                       text,
                       {}};
  result.source.set_language(InputLanguage::yaml);
  result.source.set_text(plain);
  const YamlFile whole{file, plain};
  YamlTree tree(whole);
  try {
    std::istringstream stream(plain);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(tree)) {
    }
  } catch (const YAML::ParserException& problem) {
    throw syntax_error(problem, whole);
  }
  if (tree.size() == 0)
    throw InputError(file + ":1: the file is empty; allowed: lists by their names, like \"Scene:\"");
  const bool goes_on = result.source.attempt([&] { YamlFiller(tree, whole, result).fill_root(spec); });
  if (mistakes == Mistakes::thrown || !goes_on) result.source.collect([] {});
  return result;
}

}  // namespace mixbeam
