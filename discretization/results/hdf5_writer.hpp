/// Ownership and checked calls over the HDF5 C library, as far as result files need them. Only sources of this folder
/// include this.
#pragma once

#include "discretization/results/guarded_file.hpp"

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam::hdf5 {

/// A call of the HDF5 library failed; the message gives the attempted action and the library's innermost reason.
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

 private:
  friend class File;
  void close() noexcept;

  hid_t id_;
  CloseFunction close_function_;
};

/// Whether closing an object of the open file failed: a destructor cannot report it.
inline bool a_close_failed = false;

enum class FileUse { create, change, read };

/// A guarded file, open in the library. Everything opened in it must be closed before it.
class File {
 public:
  /// `content` must outlive this.
  File(GuardedFile& content, FileUse use);

  operator hid_t() const { return handle_; }

  /// Closes it and throws the errors that occurred meanwhile (Error, DiskError, DamageError): the library is always
  /// told of success, since after a failure it neither closes files nor terminates reliably. The bytes written are in
  /// `content`, to be flushed.
  void close();

 private:
  /// Medium of the library's calls.
  struct Medium {
    GuardedFile* content = nullptr;
    std::exception_ptr problem{};
  };
  friend struct Driver;

  std::unique_ptr<Medium> medium_;
  Handle handle_;
};

/// How the values of an attribute or a dataset may be stored: each by the types that this program writes.
enum class Stored : unsigned { integers = 1, reals = 2, numbers = 3, texts = 4, anything = 7 };

/// A dataset that is open to be read.
struct StoredValues {
  Handle id, type, space;
  std::vector<hsize_t> shape{};  ///< empty: one value
  std::size_t bytes = 0;         ///< of all values: no more than the file has
};

/// All that is read of a result file is opened by these two and open_group(). They throw Error for whatever this
/// program does not write, before a byte of it is read: links but hard ones, values in other files, filters, types and
/// shapes of other kinds.
StoredValues open_attribute(hid_t object, const std::string& name, Stored declared);
StoredValues open_dataset(hid_t group, const std::string& name, Stored declared);
/// Describes a dataset that is open.
StoredValues values_of(Handle dataset, const std::string& name, Stored declared);

/// Throws Error where a call has failed: "cannot <action>: " and the library's reason.
void require(herr_t status, const std::string& action);

Handle create_group(hid_t parent, const std::string& name);
Handle open_group(hid_t parent, const std::string& name);

void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, int value);
void write_attribute(hid_t object, const std::string& name, bool value);  ///< 1 or 0
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_text(hid_t group, const std::string& name, const std::string& text);

/// `values` row by row; one column gives a one-dimensional dataset.
void write_dataset(hid_t group, const std::string& name, const std::vector<double>& values, std::size_t columns);

void write_dataset(hid_t group, const std::string& name, const std::vector<int>& values);
/// A dataset of texts, all as long as the longest.
void write_texts(hid_t group, const std::string& name, const std::vector<std::string>& texts);

/// Creates a dataset whose numbers (native doubles or integers, row by row) are written past the library, after the
/// file is closed: its place in the file is fixed at once and nothing is written there. One column gives a
/// one-dimensional dataset. Returns where the numbers begin; 0 when there are none.
std::uint64_t place_dataset(hid_t parent, const std::string& name, bool integers, std::size_t rows,
                            std::size_t columns);

std::size_t count_links(hid_t group);
/// Throws Error where that cannot be determined.
bool has_link(hid_t group, const std::string& name);

/// An object of a group, by name, ascending. Throws Error for links but hard ones.
struct ObjectLink {
  std::string name{};
  std::uint64_t address = 0;  ///< of the object in the file, which identifies it
};
std::vector<ObjectLink> links_of(hid_t group);
std::vector<std::string> link_names(hid_t group);
std::vector<std::string> attribute_names(hid_t object);
bool has_attribute(hid_t object, const std::string& name);
double read_number(hid_t object, const std::string& attribute);
std::string read_text_attribute(hid_t object, const std::string& attribute);
/// Throws Error also for numbers that are not finite, or no counts.
void read_attribute(hid_t object, const std::string& name, double& value);
void read_attribute(hid_t object, const std::string& name, int& value);
void read_attribute(hid_t object, const std::string& name, bool& value);
void read_attribute(hid_t object, const std::string& name, std::string& value);
std::string read_text(hid_t group, const std::string& name);
std::vector<std::string> read_texts(hid_t group, const std::string& name);
/// Reads and discards values, to check that they can be read.
void read_attributes(hid_t object);
void read_all(const StoredValues& dataset, const std::string& name);
/// Opens one of links_of(parent): a group, a dataset or neither.
Handle open_object(hid_t parent, const std::string& name);
bool is_group(hid_t object);
/// Place of the numbers of a dataset in the file, and how many bytes they are; zeros unless they lie in one piece.
std::pair<std::uint64_t, std::uint64_t> data_place(const StoredValues& dataset);
/// Reads numbers row by row, of so many columns; one column is a dataset of one dimension.
std::vector<double> read_dataset(hid_t group, const std::string& name, std::size_t columns,
                                 Stored declared = Stored::reals);
/// Reads numbers row by row; `columns` becomes the length of a row.
std::vector<double> read_series(hid_t group, const std::string& name, std::size_t& columns);

/// Appends rows to the dataset `name` of so many columns; creates it if it is missing.
void append_rows(hid_t group, const std::string& name, const std::vector<double>& rows, std::size_t columns);
/// Appends a row to a table that has as many columns as its longest row; NaN where others have none.
void append_row(hid_t group, const std::string& name, std::vector<double> row);

/// Copies an object with everything below it.
void copy_link(hid_t source, const std::string& name, hid_t target);
void remove_link(hid_t parent, const std::string& name);

}  // namespace mixbeam::hdf5
