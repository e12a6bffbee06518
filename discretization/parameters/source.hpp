/// Where parameters came from: the file and the place of each in it, for error messages.
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

/// What a reader does with mistakes after which it could go on.
enum class Mistakes {
  thrown,  ///< all at once, at its end
  kept     ///< in the source, beside those that are found later: whoever asks for that throws them
};

/// `scene` of `folder/scene.yaml`.
std::string name_of_file(const std::string& file);

class ParameterSource {
 public:
  /// Without a file name: a list that the program made itself.
  explicit ParameterSource(std::string file = "", std::string root_name = "");

  const std::string& file() const { return file_; }
  /// Name of the outermost list.
  const std::string& root_name() const { return root_name_; }

  void set_root_name(const std::string& name) { root_name_ = name; }
  /// Its content, of which errors show the line.
  void set_text(std::string text) { text_ = std::move(text); }
  /// Language of the input, for messages. Of one in Python nobody sees the text: its places are the paths of lists.
  void set_language(InputLanguage language) { language_ = language; }
  InputLanguage language() const { return language_; }
  /// What the language of the file calls a list and a parameter.
  std::string list_word() const { return word({"ParameterList", "map", "list"}); }
  std::string parameter_word() const { return word({"Parameter", "value", "parameter"}); }
  /// Remembers the place of an entry: in YAML line and column, in XML the line and where in the text its tag begins.
  /// Throws InputError if there was one of this path before: names in a list differ.
  void record(const ParameterPath& path, int line, int column);
  /// Of what comes from another file: `where` as messages say it, "loads.csv:12".
  void record(const ParameterPath& path, const std::string& where);

  /// Texts of the files that the input names, by that name: readers take them instead of what is on the disk now.
  const std::map<std::string, std::string>& files() const { return files_; }
  void set_files(std::map<std::string, std::string> files) { files_ = std::move(files); }

  /// Runs the action. A mistake that it meets is kept, so that others are found too; false then, and for all that
  /// follows once too many are kept. What stands at or below the place of an earlier mistake follows from that.
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
  /// Runs the action, then throws all mistakes that were kept, the first twenty in full: as one InputError, in the
  /// order of the file. Inside another collect() they wait for the end of that.
  template <class Action>
  void collect(const Action& action) const {
    const Depth inside(*kept_);
    attempt(action);
    throw_kept();
  }
  /// `path`: where it stands unless the mistake knows that itself.
  void keep(const InputError& mistake, const ParameterPath& path = {}) const;
  bool is_full() const { return kept_->mistakes.size() >= Kept::kMost; }
  /// Whether some mistake stands at or below this path.
  bool has_mistake(const ParameterPath& path) const;
  bool has_mistakes() const { return !kept_->mistakes.empty(); }
  /// Nothing of the kind that belongs there could take the place of a mistake.
  void cannot_mend() const { kept_->is_mended = false; }
  /// Leaves collect() where what follows would depend on a mistake that could not be mended.
  void require_mended() const {
    if (!kept_->is_mended || is_full()) throw InputError("");
  }
  void require_none() const {
    if (has_mistakes()) throw InputError("");
  }

  /// Line of this very path, 0 if it was not in the file.
  int line(const ParameterPath& path) const;

  /// `scene.xml:12`, `scene.yaml:12:3`; for something that is missing, the place of the innermost list around it.
  std::string where(const ParameterPath& path) const;

  /// `scene.xml:12: XML path "Scene / Members": <remark>`
  std::string message(const ParameterPath& path, const std::string& remark) const;
  /// The same as an error, with the line of the file and a mark below the place: the value where `problem` speaks of
  /// one, else the name.
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

  /// What attempt() has kept: a notebook that all copies of a source share.
  struct Kept {
    struct Mistake {
      InputError error;
      Position position;
    };
    static constexpr std::size_t kMost = 40;  ///< names near each of them may be looked for among a million
    std::vector<Mistake> mistakes{};
    bool is_mended = true;
    int depth = 0;  ///< of collect()
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
  /// Of the place, or of the innermost list around it.
  Position position_around(std::string place) const;
  std::string text_of(const Position& position) const;
  std::string word(const std::array<const char*, 3>& by_language) const;
  /// Further lines of a message: the line of the file and a mark below the place.
  std::string marked(ParameterPath path, const std::string& problem) const;
  std::string marked_in_table(const std::string& place) const;
  std::map<std::string, std::string> files_;
};

/// A place in what a user wrote: a list or a parameter, which errors point to and formulas stand at. The source must
/// outlive it.
class InputPlace {
 public:
  InputPlace(const ParameterSource& source, ParameterPath path) : source_(&source), path_(std::move(path)) {}

  const ParameterSource& source() const { return *source_; }
  /// One level deeper.
  InputPlace operator[](const std::string& name) const { return {*source_, child(path_, name)}; }
  InputError error(const std::string& problem) const { return source_->error(path_, problem); }
  /// As that of the source. A mistake is not kept where the entry that stands here has one already: it may follow from
  /// that.
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

/// The formula that a parameter holds. Throws InputError for a text that is none, or that uses other names than
/// `variables`.
Expression checked_formula(const std::string& text, const std::vector<std::string>& variables, const InputPlace& place);

/// Throws InputError unless the formula has a finite value at each of the `samples` (one value per variable each). A
/// sample can miss a pole; it finds the slips that matter: a division by s at the start, a root of 1 - x that should
/// have been one of x - 1.
void check_finite(const Expression& formula, const std::vector<std::string>& variables,
                  const std::vector<std::vector<double>>& samples, const InputPlace& place);

}  // namespace mixbeam
