/// Ownership and checked calls over the HDF5 C library, as far as result files need them. Only result_file.cpp,
/// stored_run.cpp and table_file.cpp include this.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam::hdf5 {

/// A call of the HDF5 library failed; the message says what was tried and the library's innermost reason.
class Error : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// While alive, the library prints nothing about errors: they reach the user as exceptions instead.
class QuietScope {
 public:
  QuietScope();
  ~QuietScope();
  QuietScope(const QuietScope&) = delete;
  QuietScope& operator=(const QuietScope&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// Owns one identifier of the library (file, group, dataset, ...).
class Handle {
 public:
  using CloseFunction = herr_t (*)(hid_t);

  /// Takes over `id`; throws Error with `action` ("create group steps") when the library returned none.
  Handle(hid_t id, CloseFunction close_function, const std::string& action);
  ~Handle();
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_function_(other.close_function_) {}
  Handle& operator=(Handle&&) = delete;

  operator hid_t() const { return id_; }

  /// Closes now and reports failure, which for a file is where a full disk shows.
  void close(const std::string& action);

 private:
  hid_t id_;
  CloseFunction close_function_;
};

Handle create_file(const std::filesystem::path& path);
Handle open_file(const std::filesystem::path& path);
Handle create_group(hid_t parent, const std::string& name);
Handle open_group(hid_t parent, const std::string& name);

void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, int value);
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_text(hid_t group, const std::string& name, const std::string& text);

/// `values` row by row; one column gives a one-dimensional dataset.
void write_dataset(hid_t group, const std::string& name, const std::vector<double>& values, std::size_t columns);

/// Creates a dataset whose numbers (native doubles or integers, row by row) others write past the library, after the
/// file is closed: its place in the file is settled at once and nothing is written there. One column gives a
/// one-dimensional dataset. Returns where the numbers begin; 0 when there are none.
std::uint64_t place_dataset(hid_t parent, const std::string& name, bool integers, std::size_t rows,
                            std::size_t columns);

std::size_t count_links(hid_t group);

Handle open_file_to_read(const std::filesystem::path& path);
/// Names below a group, ascending.
std::vector<std::string> link_names(hid_t group);
std::vector<std::string> attribute_names(hid_t object);
double read_number(hid_t object, const std::string& attribute);
std::string read_text_attribute(hid_t object, const std::string& attribute);
std::string read_text(hid_t group, const std::string& name);
/// Row by row; `columns`, when asked for, is the length of a row (1 for one dimension).
std::vector<double> read_dataset(hid_t group, const std::string& name, std::size_t* columns = nullptr);

/// Lengthens the dataset `name` of as many columns as `row` has by that row; creates it when it is missing.
void append_row(hid_t group, const std::string& name, const std::vector<double>& row);

}  // namespace mixbeam::hdf5
