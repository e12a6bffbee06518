#include "discretization/text/csv_file.hpp"

#include "discretization/text/message_text.hpp"
#include "discretization/text/text_file.hpp"

#include <libxml/xmlstring.h>

#include <algorithm>
#include <utility>

namespace mixbeam {
namespace {

const std::string kByteOrderMark = "\xEF\xBB\xBF";

bool is_line_end(char c) { return c == '\n' || c == '\r'; }
bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// Reads the records of a text, from start to end.
class CsvScanner {
 public:
  CsvScanner(const CsvFile& file, const std::string& text) : file_(file), text_(text) {}

  /// Reads the next record; false at the end of the text.
  bool next(CsvRecord& record) {
    record.cells.clear();
    record.columns.clear();
    if (!skip_to_record()) return false;
    if (separator_ == '\0') separator_ = find_separator();
    record.line = line_;
    do {
      read_cell(record);
    } while (take_separator());
    end_line();
    return true;
  }

 private:
  bool at_end() const { return at_ == text_.size(); }
  bool at_line_end() const { return at_end() || is_line_end(text_[at_]); }

  /// Column in characters of UTF-8, not bytes. Continues counting from the place of the last call.
  int column() {
    if (counted_to_ < line_begin_ || counted_to_ > at_) {
      counted_to_ = line_begin_;
      counted_ = 0;
    }
    for (; counted_to_ < at_; ++counted_to_) counted_ += (text_[counted_to_] & 0xC0) != 0x80 ? 1 : 0;
    return 1 + counted_;
  }

  void end_line() {
    if (at_end()) return;
    if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++at_;
    ++at_;
    ++line_;
    line_begin_ = at_;
  }

  /// Skips empty lines and comments; false at the end of the text.
  bool skip_to_record() {
    while (!at_end()) {
      while (!at_line_end() && is_blank(text_[at_])) ++at_;
      const bool comment = !at_end() && text_[at_] == '#';
      if (comment)
        while (!at_line_end()) ++at_;
      if (!at_line_end()) {
        at_ = line_begin_;  // an empty first cell may precede a tabulator
        return true;
      }
      end_line();
    }
    return false;
  }

  char find_separator() const {
    bool quoted = false;
    std::string seen;
    for (std::size_t i = at_; i < text_.size() && (quoted || !is_line_end(text_[i])); ++i) {
      if (text_[i] == '"') quoted = !quoted;
      if (!quoted) seen += text_[i];
    }
    for (const char candidate : {';', '\t'})
      if (seen.find(candidate) != std::string::npos) return candidate;
    return ',';
  }

  bool take_separator() {
    if (at_line_end() || text_[at_] != separator_) return false;
    ++at_;
    return true;
  }

  void skip_blanks() {
    while (!at_line_end() && is_blank(text_[at_]) && text_[at_] != separator_) ++at_;
  }

  void read_cell(CsvRecord& record) {
    skip_blanks();
    record.columns.push_back(column());
    if (!at_line_end() && text_[at_] == '"') {
      record.cells.push_back(quoted_cell());
      skip_blanks();
      if (!at_line_end() && text_[at_] != separator_)
        throw file_.error(line_, column(), "text after a closing quote; allowed: the separator or the end of the line");
      return;
    }
    const std::size_t begin = at_;
    while (!at_line_end() && text_[at_] != separator_) ++at_;
    std::size_t end = at_;
    while (end > begin && is_blank(text_[end - 1])) --end;
    record.cells.push_back(text_.substr(begin, end - begin));
  }

  std::string quoted_cell() {
    const int opened = column();
    std::string cell;
    for (++at_; !at_line_end(); ++at_) {
      if (text_[at_] == '"') {
        ++at_;
        if (at_end() || text_[at_] != '"') return cell;
      }
      cell += text_[at_];
    }
    throw file_.error(line_, opened,
                      "a quote that is not closed in its line; allowed: \"...\", a quote inside doubled");
  }

  const CsvFile& file_;
  const std::string& text_;
  std::size_t at_ = 0, line_begin_ = 0;
  std::size_t counted_to_ = 0;  ///< counted_: characters of the line before this
  int counted_ = 0;
  int line_ = 1;
  char separator_ = '\0';
};

}  // namespace

CsvFile::CsvFile(const std::string& path) : path_(path), text_(text_of_file(path, "a table")) { prepare(); }

CsvFile::CsvFile(std::string path, std::string text) : path_(std::move(path)), text_(std::move(text)) { prepare(); }

void CsvFile::prepare() {
  if (text_.compare(0, kByteOrderMark.size(), kByteOrderMark) == 0) text_.erase(0, kByteOrderMark.size());
  std::size_t bad = text_.find('\0');
  for (std::size_t begin = 0; begin < text_.size() && bad == std::string::npos;) {
    const std::size_t end = std::min(text_.find('\n', begin), text_.size());
    if (xmlCheckUTF8(reinterpret_cast<const xmlChar*>(text_.substr(begin, end - begin).c_str())) == 0) bad = begin;
    begin = end + 1;
  }
  if (bad == std::string::npos) return;
  const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(bad), '\n');
  throw InputError(path_ + ":" + std::to_string(line) +
                   ": not a text in UTF-8; allowed: a table as text, which programs save as \"CSV UTF-8\"");
}

void CsvFile::for_each(const std::function<void(const CsvRecord&)>& action) const {
  CsvScanner scanner(*this, text_);
  for (CsvRecord record; scanner.next(record);) action(record);
}

InputError CsvFile::error(int line, int column, const std::string& problem) const {
  return InputError{where(line, column) + ": " + problem + marked_line(text_, offset_of(text_, line, column))};
}

std::string CsvFile::where(const CsvRecord& record, std::size_t cell) const {
  return where(record.line, cell < record.columns.size() ? record.columns[cell] : 1);
}

InputError CsvFile::error(const CsvRecord& record, std::size_t cell, const std::string& problem) const {
  return error(record.line, cell < record.columns.size() ? record.columns[cell] : 1, problem);
}

CsvRecord CsvFile::record_at(int line) const {
  CsvScanner scanner(*this, text_);
  for (CsvRecord record; scanner.next(record);)
    if (record.line == line) return record;
  return {line, {}, {}};
}

}  // namespace mixbeam
