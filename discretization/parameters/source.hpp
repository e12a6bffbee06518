/// Origin of parameters, for error messages: the file, and the place of each entry in it.
#pragma once

#include "discretization/text/errors.hpp"
#include "discretization/text/expression.hpp"

#include <array>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mixbeam {

/// Names from the root (itself not included) down to a parameter or list: {"Scene", "Members", "shaft", "Elements"}.
using ParameterPath = std::vector<std::string>;

/// `Scene / Members / shaft / Elements`
std::string to_string(const ParameterPath& path);

/// `path` one level deeper.
ParameterPath child(ParameterPath path, const std::string& name);

enum class InputLanguage { xml, yaml, python };

/// Treatment of mistakes after which a reader can go on.
enum class Mistakes {
  thrown,  ///< together, at the end of reading
  kept     ///< in the source, with those found later; a caller that asks for this throws them
};

/// Name of a file without folder and extension: `scene` of `folder/scene.yaml`.
std::string name_of_file(const std::string& file);

class ParameterSource {
 public:
  /// Without a file name: a list made by the program itself.
  explicit ParameterSource(std::string file = "", std::string root_name = "");

  const std::string& file() const { return file_; }
  /// Name of the outermost list.
  const std::string& root_name() const { return root_name_; }

  void set_root_name(const std::string& name) { root_name_ = name; }
  /// Sets the text of the file; errors show the line in it.
  void set_text(std::string text) { text_ = std::move(text); }
  /// Language of the input, for messages. The text of input from Python is not shown: its places are paths of lists.
  void set_language(InputLanguage language) { language_ = language; }
  InputLanguage language() const { return language_; }
  /// Word for a list or a parameter in the language of the file.
  std::string list_word() const { return word({"ParameterList", "map", "list"}); }
  std::string parameter_word() const { return word({"Parameter", "value", "parameter"}); }
  /// Remembers the place of an entry: line and column in YAML, line and offset of its tag in XML. Throws InputError if
  /// the path was recorded before: names in a list must differ.
  void record(const ParameterPath& path, int line, int column);
  /// Remembers the place of an entry from another file: `where` as in messages, "loads.csv:12".
  void record(const ParameterPath& path, const std::string& where);

  /// Texts of the files that the input names, by that name: readers use them instead of the files on disk.
  const std::map<std::string, std::string>& files() const { return files_; }
  void set_files(std::map<std::string, std::string> files) { files_ = std::move(files); }

  /// Runs the action; keeps a mistake that it throws, so that others are found too, and returns false. Does nothing
  /// once too many are kept. A mistake at, above or below the place of an earlier one follows from it and is dropped.
  template <class Action>
  bool attempt(const Action& action) const {
    if (is_full()) return false;
    try {
      action();
      return true;
    } catch (const InputError& mistake) {
      keep(mistake);
      return false;
    }
  }
  /// Runs the action, then throws all mistakes kept as one InputError, the first twenty in full, in the order of the
  /// file. Inside another collect() they wait for its end.
  template <class Action>
  void collect(const Action& action) const {
    const Depth inside(*kept_);
    attempt(action);
    throw_kept();
  }
  /// Keeps a mistake; `path`: its place, unless it knows that itself.
  void keep(const InputError& mistake, const ParameterPath& path = {}) const;
  bool is_full() const { return kept_->mistakes.size() >= Kept::kMost; }
  /// Whether there is a mistake at or below this path.
  bool has_mistake(const ParameterPath& path) const;
  bool has_mistakes() const { return !kept_->mistakes.empty(); }
  /// Notes that a mistake could not be replaced by an allowed value.
  void cannot_mend() const { kept_->is_mended = false; }
  /// Leaves collect() if a mistake could not be mended: what follows would depend on it.
  void require_mended() const {
    if (!kept_->is_mended || is_full()) throw InputError("");
  }
  void require_none() const {
    if (has_mistakes()) throw InputError("");
  }

  /// Line of this very path, 0 if it was not in the file.
  int line(const ParameterPath& path) const;

  /// `scene.xml:12`, `scene.yaml:12:3`; for a missing entry, the place of the innermost list around it.
  std::string where(const ParameterPath& path) const;

  /// `scene.xml:12: XML path "Scene / Members": <remark>`
  std::string message(const ParameterPath& path, const std::string& remark) const;
  /// Error with that message, the line of the file and a mark below the place: below the value if `problem` begins with
  /// that word, else below the name.
  InputError error(const ParameterPath& path, const std::string& problem) const;

 private:
  std::string file_;
  std::string root_name_;
  std::string text_;
  InputLanguage language_ = InputLanguage::xml;
  struct Position {
    int line = 0, column = 0;
  };
  std::unordered_map<std::string, Position> positions_;
  std::unordered_map<std::string, std::string> elsewhere_;

  /// Mistakes kept by attempt(); all copies of a source share them.
  struct Kept {
    struct Mistake {
      InputError error;
      Position position;
    };
    static constexpr std::size_t kMost = 40;  ///< each may cost a search for the nearest among a million names
    std::vector<Mistake> mistakes{};
    bool is_mended = true;
    int depth = 0;  ///< nesting of collect()
  };
  struct Depth {
    explicit Depth(Kept& of) : kept(of) { ++kept.depth; }
    ~Depth() { --kept.depth; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;
    Kept& kept;
  };
  void throw_kept() const;
  std::shared_ptr<Kept> kept_ = std::make_shared<Kept>();

  Position position(const ParameterPath& path) const;
  /// Position of the place, or of the innermost list around it.
  Position position_around(std::string place) const;
  std::string text_of(const Position& position) const;
  std::string word(const std::array<const char*, 3>& by_language) const;
  /// Further lines of a message: the line of the file and a mark below the place.
  std::string marked(ParameterPath path, const std::string& problem) const;
  std::string marked_in_table(const std::string& place) const;
  std::map<std::string, std::string> files_;
};

/// Place in the input, a list or a parameter, that errors and formulas refer to. The source must outlive it.
class InputPlace {
 public:
  InputPlace(const ParameterSource& source, ParameterPath path) : source_(&source), path_(std::move(path)) {}

  const ParameterSource& source() const { return *source_; }
  /// One level deeper.
  InputPlace operator[](const std::string& name) const { return {*source_, child(path_, name)}; }
  InputError error(const std::string& problem) const { return source_->error(path_, problem); }
  /// Like ParameterSource::attempt(), but drops a mistake if this entry has one already: it may follow from that.
  template <class Action>
  bool attempt(const Action& action) const {
    if (source_->is_full()) return false;
    try {
      action();
      return true;
    } catch (const InputError& mistake) {
      if (!source_->has_mistake(path_)) source_->keep(mistake, path_);
      return false;
    }
  }

 private:
  const ParameterSource* source_;
  ParameterPath path_;
};

/// Parses the formula of a parameter. Throws InputError for a text that is not a formula, or that uses other names than
/// `variables`.
Expression checked_formula(const std::string& text, const std::vector<std::string>& variables, const InputPlace& place);

/// Throws InputError unless the formula has a finite value at each of the `samples` (one value per variable each).
/// Samples can miss a pole, but find the slips that matter: a division by s at the start, a root of 1 - x that should
/// have been one of x - 1.
void check_finite(const Expression& formula, const std::vector<std::string>& variables,
                  const std::vector<std::vector<double>>& samples, const InputPlace& place);

}  // namespace mixbeam
