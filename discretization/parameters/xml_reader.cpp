#include "discretization/parameters/parameter_file.hpp"

#include "discretization/parameters/value.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/tags.hpp"

#include <libxml/SAX2.h>
#include <libxml/parserInternals.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <utility>

namespace mixbeam {
namespace {

constexpr std::size_t kMaximumBytes = std::size_t{256} << 20U;  // as for files

const std::vector<std::string> kTags = {"ParameterList", "Parameter"};
// Teuchos itself writes the last four of each; they are not needed here.
const std::vector<std::string> kListAttributes = {"name", "id", "docString", "isDefault", "isUsed"};
const std::vector<std::string> kParameterAttributes = {"name",      "type",      "value", "id",
                                                       "docString", "isDefault", "isUsed"};

/// Names and values; a tag has few, and the parser refuses equal names.
using Attributes = std::vector<std::pair<std::string, std::string>>;

const std::string* find_attribute(const Attributes& attributes, const std::string& name) {
  for (const auto& attribute : attributes)
    if (attribute.first == name) return &attribute.second;
  return nullptr;
}

/// Receives the parser's events and builds the list. The events come through C code, which an exception must not
/// cross: the first error is kept and the parser stopped.
class ListBuilder {
 public:
  ListBuilder(xmlParserCtxtPtr parser, XmlParameters& result) : parser_(parser), result_(result) {}

  /// First error; null while there is none.
  const std::exception_ptr& error() const { return error_; }
  bool has_root() const { return has_root_; }

  template <typename Event>
  void guarded(Event event) {
    if (error_) return;
    try {
      event();
    } catch (const InputError&) {
      stop(std::current_exception());
    } catch (const std::bad_alloc&) {
      stop(std::current_exception());
    } catch (const std::exception& error) {
      stop(std::make_exception_ptr(result_.source.error(path_, error.what())));
    }
  }

  void start_element(const std::string& tag, const Attributes& attributes) {
    const Place place = tag_place();
    if (inside_parameter_)
      throw error_at(
          place, "<" + excerpt(tag) + "> inside a <Parameter>; allowed: nothing, <Parameter ... /> ends with a slash");
    if (tag == "ParameterList") return start_list(attributes, place);
    if (tag == "Parameter") return start_parameter(attributes, place);
    throw error_at(place,
                   "unknown tag <" + excerpt(tag) + ">; allowed: " + quoted_list(kTags) + did_you_mean(tag, kTags));
  }

  void end_element(const std::string& tag) {
    line_of_end_ = line();
    if (tag == "Parameter") {
      inside_parameter_ = false;
      return;
    }
    take_comments(Comment::Place::end, path_);
    last_ended_ = path_;
    open_.pop_back();
    indents_.pop_back();
    if (!path_.empty()) path_.pop_back();
  }

  /// A comment behind an entry in its line belongs to that entry.
  void comment(const std::string& text) {
    const bool is_behind = line_of_end_ > 0 && line_of_end_ == tag_place().line && pending_comments_.empty();
    if (is_behind) return result_.comments.push_back({Comment::Place::behind, last_ended_, trimmed(text)});
    pending_comments_.push_back(trimmed(text));
  }

  void end_document() { take_comments(Comment::Place::end, {}); }

  void characters(const std::string& text) {
    if (trimmed(text).empty()) return;
    throw error_at(tag_place(), "text \"" + excerpt(trimmed(text)) +
                                    "\" outside of tags; allowed: <ParameterList> and <Parameter .../> only");
  }

  void document_type() {
    throw error_at(tag_place(), "a DOCTYPE, which could include other files; allowed: a plain list of parameters");
  }

  void syntax_error(const xmlError& problem) {
    const std::string text = problem.message == nullptr ? "unreadable" : trimmed(problem.message);
    const int column = std::max(problem.int2, 1);
    std::string hint;
    if (text.find("attributes construct") != std::string::npos) hint = "; a quote of an attribute is missing";
    if (text.find("EntityRef") != std::string::npos) hint = "; & in a text is written &amp;";
    throw error_at({problem.line, static_cast<int>(offset_of(result_.text, problem.line, column))},
                   "not well-formed XML: " + excerpt(text) + hint + not_closed_ + "; nothing after this line was read");
  }

 private:
  void stop(const std::exception_ptr& error) {
    error_ = error;
    xmlStopParser(parser_);
  }

  int line() const { return xmlSAX2GetLineNumber(parser_); }

  struct Place {
    int line = 0, offset = 0;
  };

  /// Place where a tag begins; the parser is at its end, maybe lines below.
  Place tag_place() const {
    Place place{line(), 0};
    const xmlChar* begin = parser_->input->cur;
    while (begin > parser_->input->base && *begin != '<') {
      --begin;
      if (*begin == '\n') --place.line;
    }
    place.offset = static_cast<int>(parser_->input->consumed) + static_cast<int>(begin - parser_->input->base);
    return *begin == '<' ? place : Place{line(), place.offset};
  }

  /// Bytes before the tag in its line; 0 if there are very many.
  int indent(const Place& place) const {
    constexpr int kMost = 200;
    for (int i = 1; i <= std::min(place.offset, kMost); ++i)
      if (result_.text[place.offset - i] == '\n') return i - 1;
    return 0;
  }

  InputError error_at(const Place& place, const std::string& problem) const {
    const std::string inside = path_.empty() ? "" : "XML path \"" + to_string(path_) + "\": ";
    return InputError{result_.source.file() + ":" + std::to_string(place.line) + ": " + inside + problem +
                      marked_line(result_.text, static_cast<std::size_t>(place.offset))};
  }

  void check_attributes(const Attributes& attributes, const std::vector<std::string>& allowed,
                        const Place& place) const {
    for (const auto& attribute : attributes) {
      if (std::find(allowed.begin(), allowed.end(), attribute.first) != allowed.end()) continue;
      result_.source.keep(error_at(place, "unknown attribute \"" + excerpt(attribute.first) + "\"; allowed: " +
                                              quoted_list(allowed) + did_you_mean(attribute.first, allowed)));
    }
  }

  const std::string& attribute(const Attributes& attributes, const std::string& name, const std::string& tag,
                               const Place& place) const {
    if (const std::string* found = find_attribute(attributes, name)) return *found;
    const std::string problem = "<" + tag + "> without the attribute \"" + name + "\"";
    if (name == "name") throw error_at(place, problem);
    throw result_.source.error(path_, problem + (name == "type" ? "; allowed: " + quoted_list(xml_names()) : ""));
  }

  const std::string& name_of(const Attributes& attributes, const std::string& tag, const Place& place) const {
    const std::string& name = attribute(attributes, "name", tag, place);
    if (trimmed(name).empty()) throw error_at(place, "<" + tag + "> with an empty name");
    return name;
  }

  void start_list(const Attributes& attributes, const Place& place) {
    check_attributes(attributes, kListAttributes, place);
    if (!has_root_) return start_root(attributes, place);
    if (open_.size() >= kDeepestLists) {
      throw error_at(place, "lists nested deeper than " + std::to_string(kDeepestLists));
    }
    const std::string& name = name_of(attributes, "ParameterList", place);
    if (not_closed_.empty() && indent(place) <= indents_.back() && indent(place) > 0)
      not_closed_ = "; the list \"" + to_string(path_) + "\" seems to have no </ParameterList>: \"" + excerpt(name) +
                    "\" in line " + std::to_string(place.line) + " would stand inside it";
    path_.push_back(name);
    result_.source.attempt([&] { result_.source.record(path_, place.line, place.offset); });
    take_comments(Comment::Place::before, path_);
    if (open_.back()->isParameter(name) && !open_.back()->isSublist(name)) open_.back()->remove(name);  // given twice
    open_.push_back(&open_.back()->sublist(name));
    indents_.push_back(indent(place));
  }

  /// Teuchos does not require a name of the outermost list; here that of the file is used.
  void start_root(const Attributes& attributes, const Place& place) {
    const std::string* name = find_attribute(attributes, "name");
    result_.list->setName(name == nullptr ? name_of_file(result_.source.file()) : *name);
    result_.source.set_root_name(result_.list->name());
    result_.source.record({}, place.line, place.offset);
    indents_.push_back(indent(place));
    take_comments(Comment::Place::before, {});
    open_.push_back(result_.list.get());
    has_root_ = true;
  }

  void start_parameter(const Attributes& attributes, const Place& place) {
    inside_parameter_ = true;
    if (open_.empty()) throw error_at(place, "<Parameter> outside of a list; allowed: one <ParameterList> around all");
    const ParameterPath around = path_;
    result_.source.attempt([&] { read_parameter(attributes, place); });
    path_ = around;
  }

  void read_parameter(const Attributes& attributes, const Place& place) {
    check_attributes(attributes, kParameterAttributes, place);
    path_.push_back(name_of(attributes, "Parameter", place));
    const std::string name = path_.back();
    last_ended_ = path_;
    result_.source.record(path_, place.line, place.offset);
    const std::string& type = attribute(attributes, "type", "Parameter", place);
    const std::string& value = attribute(attributes, "value", "Parameter", place);
    take_comments(Comment::Place::before, path_);
    const std::vector<std::string>& types = xml_names();
    const auto known = std::find(types.begin(), types.end(), type);
    if (known == types.end()) {
      throw result_.source.error(
          path_, "unknown type \"" + excerpt(type) + "\"; allowed: " + quoted_list(types) + did_you_mean(type, types));
    }
    ParameterValue parsed;
    const Problem problem = parse_value(value, static_cast<ParameterType>(known - types.begin()), parsed);
    if (!problem.empty()) throw result_.source.error(path_, problem);
    set_value(*open_.back(), name, parsed);
    if (!has_type(parsed, static_cast<ParameterType>(known - types.begin())))  // a formula
      open_.back()->getEntry(name).setDocString(type);
  }

  /// Assigns the comments read since the last entry to this one.
  void take_comments(Comment::Place place, const ParameterPath& path) {
    for (std::string& text : pending_comments_) result_.comments.push_back({place, path, std::move(text)});
    pending_comments_.clear();
  }

  xmlParserCtxtPtr parser_;
  XmlParameters& result_;
  std::exception_ptr error_;
  std::vector<Teuchos::ParameterList*> open_;  ///< lists that have not ended
  std::vector<int> indents_;                   ///< of their tags
  std::string not_closed_;                     ///< for the first list that contains another one with no more indent
  ParameterPath path_;
  std::vector<std::string> pending_comments_;
  ParameterPath last_ended_;  ///< the entry whose tag ended last
  int line_of_end_ = 0;
  bool has_root_ = false;
  bool inside_parameter_ = false;
};

std::string to_string(const xmlChar* text) { return text == nullptr ? "" : reinterpret_cast<const char*>(text); }

std::string prefixed(const xmlChar* prefix, const xmlChar* name) {
  return prefix == nullptr ? to_string(name) : to_string(prefix) + ":" + to_string(name);
}

// The parser's C interface: attributes come as name, prefix, namespace, begin and end of the value.

template <typename Event>
void tell(void* builder, Event event) {
  auto& target = *static_cast<ListBuilder*>(builder);
  target.guarded([&] { event(target); });
}

void on_start_element(void* builder, const xmlChar* name, const xmlChar* prefix, const xmlChar* /*uri*/,
                      int /*namespaces*/, const xmlChar** /*namespace_names*/, int attribute_count, int /*defaulted*/,
                      const xmlChar** attributes) {
  tell(builder, [&](ListBuilder& target) {
    Attributes values;
    values.reserve(static_cast<std::size_t>(attribute_count));
    for (int i = 0; i < attribute_count; ++i, attributes += 5) {
      const char* const begin = reinterpret_cast<const char*>(attributes[3]);
      const char* const end = reinterpret_cast<const char*>(attributes[4]);
      values.emplace_back(prefixed(attributes[1], attributes[0]), std::string(begin, end));
    }
    target.start_element(prefixed(prefix, name), values);
  });
}

void on_end_element(void* builder, const xmlChar* name, const xmlChar* prefix, const xmlChar* /*uri*/) {
  tell(builder, [&](ListBuilder& target) { target.end_element(prefixed(prefix, name)); });
}

void on_characters(void* builder, const xmlChar* text, int length) {
  tell(builder, [&](ListBuilder& target) {
    target.characters(std::string(reinterpret_cast<const char*>(text), static_cast<std::size_t>(length)));
  });
}

void on_comment(void* builder, const xmlChar* text) {
  tell(builder, [&](ListBuilder& target) { target.comment(to_string(text)); });
}

void on_document_type(void* builder, const xmlChar* /*name*/, const xmlChar* /*id*/, const xmlChar* /*system_id*/) {
  tell(builder, [](ListBuilder& target) { target.document_type(); });
}

void on_error(void* builder, xmlErrorPtr problem) {
  if (problem == nullptr || problem->level < XML_ERR_ERROR) return;
  tell(builder, [&](ListBuilder& target) { target.syntax_error(*problem); });
}

struct FreeParser {
  void operator()(xmlParserCtxtPtr parser) const { xmlFreeParserCtxt(parser); }
};

void connect(xmlParserCtxt& parser, ListBuilder& builder) {
  std::memset(parser.sax, 0, sizeof(xmlSAXHandler));  // no handler but ours: nothing is loaded, nothing printed
  parser.sax->initialized = XML_SAX2_MAGIC;
  parser.sax->startElementNs = on_start_element;
  parser.sax->endElementNs = on_end_element;
  parser.sax->characters = on_characters;
  parser.sax->cdataBlock = on_characters;
  parser.sax->comment = on_comment;
  parser.sax->internalSubset = on_document_type;
  parser.sax->serror = on_error;
  parser.userData = &builder;
}

void say_nothing(void* /*context*/, const char* /*message*/, ...) {}

/// Silences errors of encodings, which bypass the parser's own handler: libxml2 would print them to stderr. They also
/// make the document ill-formed.
class SilentParsing {
 public:
  SilentParsing() : print_(xmlGenericError), context_(xmlGenericErrorContext) {
    xmlSetGenericErrorFunc(nullptr, say_nothing);
  }
  ~SilentParsing() { xmlSetGenericErrorFunc(context_, print_); }
  SilentParsing(const SilentParsing&) = delete;
  SilentParsing& operator=(const SilentParsing&) = delete;

 private:
  xmlGenericErrorFunc print_;
  void* context_;
};

/// The parser compares all pairs of attributes of a tag.
constexpr int kMostAttributes = 100;

}  // namespace

XmlParameters parse_xml(const std::string& text, const std::string& file, Mistakes mistakes) {
  if (trimmed(text).empty()) throw InputError(file + ":1: the file is empty; allowed: a <ParameterList>");
  if (text.size() > kMaximumBytes) throw InputError(file + ": too large");
  if (const int line = line_of_tag_with_more(kMostAttributes, text); line > 0)
    throw InputError(file + ":" + std::to_string(line) + ": a tag with more than " + std::to_string(kMostAttributes) +
                     " attributes; allowed: " + quoted_list(kParameterAttributes));
  XmlParameters result{Teuchos::rcp(new Teuchos::ParameterList), ParameterSource(file), text};
  result.source.set_text(text);
  const SilentParsing silence;
  const std::unique_ptr<xmlParserCtxt, FreeParser> parser(
      xmlCreateMemoryParserCtxt(text.data(), static_cast<int>(text.size())));
  if (!parser) throw InputError(file + ":1: cannot be read as XML");
  ListBuilder builder(parser.get(), result);
  connect(*parser, builder);
  // NOENT: `&amp;` arrives as `&`; entities of the file's own cannot exist because a DOCTYPE is refused.
  xmlCtxtUseOptions(parser.get(), XML_PARSE_NONET | XML_PARSE_NOENT);
  xmlParseDocument(parser.get());
  if (builder.error()) result.source.collect([&] { std::rethrow_exception(builder.error()); });
  builder.end_document();
  if (parser->wellFormed == 0 || !builder.has_root()) throw InputError(file + ":1: not well-formed XML");
  if (mistakes == Mistakes::thrown) result.source.collect([] {});
  return result;
}

}  // namespace mixbeam
