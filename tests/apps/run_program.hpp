/// Starts an application as a user does, and returns its exit code.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace mixbeam {

/// A folder of the build for one test, emptied when it starts.
inline std::filesystem::path folder_for(const std::string& test) {
  const std::filesystem::path folder = std::filesystem::path(MIXBEAM_BIN_DIR) / "test_results" / test;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

/// Runs `program` of the build with these arguments on one thread; what it prints goes to <folder>/output.txt.
inline int run_program(const std::string& program, const std::string& arguments, const std::filesystem::path& folder) {
  const std::string command = std::string(MIXBEAM_BIN_DIR) + "/" + program + " " + arguments +
                              " --quiet --threads 1 --output " + folder.string() + " > " +
                              (folder / "output.txt").string() + " 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The application's own scene file with one piece of text replaced, written to <folder>/scene.xml.
inline std::string changed_scene(const std::string& program, const std::string& from, const std::string& to,
                                 const std::filesystem::path& folder) {
  std::string scene = text_of(std::filesystem::path(MIXBEAM_BIN_DIR) / (program + ".xml"));
  const std::size_t place = scene.find(from);
  if (place == std::string::npos) throw std::invalid_argument("the scene of " + program + " holds no " + from);
  const std::filesystem::path file = folder / "scene.xml";
  std::ofstream(file) << scene.replace(place, from.size(), to);
  return file.string();
}

}  // namespace mixbeam
