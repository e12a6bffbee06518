#include "apps/common/session/command_line.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "apps/mixbeam/view_page.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/text_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <sstream>
#include <thread>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

constexpr int kRenewed = 2;                              ///< seconds between reloads of a watched page
constexpr std::chrono::milliseconds kBetweenLooks{500};  ///< polling interval of a watched file

bool is_scene_file(const fs::path& file) {
  const std::string ending = lower_case(file.extension().string());
  return ending == ".xml" || ending == ".yaml" || ending == ".yml";
}

/// A folder that is removed with its contents.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "mixbeam-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw InputError("no folder can be made in " + fs::temp_directory_path().string());
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string without_prefix(const std::string& text, const std::string& prefix) {
  return text.rfind(prefix, 0) == 0 ? text.substr(prefix.size()) : text;
}

/// The undeformed structure of a scene, one file per load case, and messages about it.
struct Undeformed {
  TemporaryFolder folder;
  std::vector<fs::path> files;
  SaidOfScene said;
};

/// Runs `mixbeam check` on a scene. Throws InputError if nothing can be drawn.
std::unique_ptr<Undeformed> undeformed(const std::string& scene, const std::optional<std::string>& load_case) {
  auto drawn = std::make_unique<Undeformed>();
  const fs::path results = drawn->folder.path() / "results";
  std::vector<std::string> words = {"/proc/self/exe", "check", scene[0] == '-' ? "./" + scene : scene, "--output",
                                    results.string()};
  if (load_case) words.insert(words.end(), {"--case", *load_case});
  const std::string out_file = drawn->folder.path() / "out", err_file = drawn->folder.path() / "err";
  const int code = exit_code_of(words, {"", out_file, err_file});
  std::string refusal = text_of_file(err_file, "output");
  while (!refusal.empty() && refusal.back() == '\n') refusal.pop_back();
  refusal = without_prefix(refusal, "mixbeam: bad input: ");
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(results, ignored))
    if (entry.path().extension() == ".h5") drawn->files.push_back(entry.path());
  if (drawn->files.empty())
    throw InputError(refusal.empty() ? scene + ": mixbeam check ended with " + std::to_string(code) : refusal);
  const auto written = [](const fs::path& file) { return fs::last_write_time(file); };
  std::sort(drawn->files.begin(), drawn->files.end(),
            [&](const fs::path& a, const fs::path& b) { return written(a) < written(b); });
  drawn->said.refusal = code == 0 ? "" : refusal;
  std::istringstream out(text_of_file(out_file, "output"));
  const std::string warning = "warning: ";
  for (std::string line; std::getline(out, line);)
    if (line.rfind(warning, 0) == 0) drawn->said.warnings.push_back(line.substr(warning.size()));
  return drawn;
}

/// Result files of a page: one run, or all runs of an envelope.
std::vector<fs::path> files_of(const fs::path& result, const std::optional<std::string>& load_case) {
  const fs::path of_case =
      load_case ? result_file_of(result.parent_path(), result.stem().string(), *load_case) : result;
  if (of_case != result && fs::is_regular_file(of_case)) {
    require_whole(of_case, {});
    return {of_case};
  }
  if (!fs::exists(result)) throw InputError(result.string() + ": no such file");
  require_whole(result, {});
  std::vector<fs::path> files;
  const std::vector<fs::path> runs = runs_of_envelope(result);
  for (const fs::path& run : runs)
    if (fs::is_regular_file(run)) files.push_back(run);
  if (!runs.empty() && load_case)
    throw InputError(result.string() + ": the envelope of several load cases; there is no " + of_case.string());
  if (!runs.empty() && files.empty())
    throw InputError(result.string() + ": the envelope of several load cases, none of whose files is beside it");
  for (const fs::path& file : files) require_whole(file, {});
  if (!runs.empty()) return files;
  if (load_case) {
    const std::string own = SampledFile(result).header().property("load_case");
    if (own != *load_case)
      throw InputError(result.string() + ": the file is " +
                       (own.empty() ? "of a scene without load cases" : "of load case " + own) + ", and there is no " +
                       of_case.filename().string() + " beside it");
  }
  return {result};
}

/// Writes the page and prints its path.
void write_view(const CommandLine& line) {
  const fs::path result(*line.scene_file), parts = plots_folder() / "viewer";
  const int renew = line.watch ? kRenewed : 0;
  std::string text;
  fs::path beside = result;
  if (is_scene_file(result)) {
    const std::unique_ptr<Undeformed> drawn = undeformed(result.string(), line.load_case);
    text = view_page(drawn->files, drawn->said, parts, renew);
  } else {
    const std::vector<fs::path> files = files_of(result, line.load_case);
    if (line.load_case) beside = files.front();
    text = view_page(files, {}, parts, renew);
  }
  const fs::path page =
      line.output ? fs::path(*line.output) : fs::path(beside).replace_filename(beside.stem().string() + "-view.html");
  write_page(page, text);
  std::cout << page.string() << std::endl;
}

/// Rewrites the page whenever the file changes; keeps the page while the file is invalid.
[[noreturn]] void watch_view(const CommandLine& line) {
  const fs::path result(*line.scene_file);
  if (!fs::exists(result)) throw InputError(result.string() + ": no such file");
  std::optional<fs::file_time_type> seen;
  for (;; std::this_thread::sleep_for(kBetweenLooks)) {
    std::error_code is_away;
    const fs::file_time_type now = fs::last_write_time(result, is_away);
    if (is_away || seen == now) continue;
    seen = now;
    try {
      write_view(line);
    } catch (const InputError& error) {
      std::cerr << "mixbeam view: " << error.what() << std::endl;
    }
  }
}

}  // namespace

int view_command(const Arguments& arguments) {
  const CommandLine line = read_command_line(arguments.count(), arguments.values.data(),
                                             {"--output", "--case", "--watch", "--help"}, "result file or scene");
  if (!line.scene_file) throw InputError("a result file is missing: mixbeam view RESULTS.h5, or SCENE.yaml");
  require_run("view", *line.scene_file);
  const auto refused = [&](const std::string& text) {
    return InputError(text.find(*line.scene_file) == std::string::npos ? *line.scene_file + ": " + text : text);
  };
  try {
    if (line.watch) watch_view(line);
    write_view(line);
  } catch (const InputError& error) {
    throw refused(error.what());
  } catch (const FileError& error) {
    throw refused(error.what());
  } catch (const fs::filesystem_error& error) {
    throw refused(error.what());
  }
  return 0;
}

}  // namespace mixbeam
