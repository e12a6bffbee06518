/// Result files through the C interface of HDF5, past the reader of the program.
#pragma once

#include "discretization/results/hdf5_writer.hpp"
#include "tests/support/files.hpp"

#include <cmath>
#include <map>
#include <optional>

namespace mixbeam {

/// Every dataset and attribute of a result file: path -> shape and bytes.
using FileContents = std::map<std::string, std::string>;

namespace h5 {

inline hdf5::Handle opened(const fs::path& file, unsigned access = H5F_ACC_RDONLY) {
  return {H5Fopen(file.c_str(), access, H5P_DEFAULT), H5Fclose, "open " + file.string()};
}
inline hdf5::Handle dataset(hid_t file, const std::string& name) {
  return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "open " + name};
}

inline std::vector<hsize_t> shape_of(hid_t dataset) {
  const hdf5::Handle space(H5Dget_space(dataset), H5Sclose, "take the space");
  std::vector<hsize_t> shape(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return shape;
}

inline std::size_t count_of(const std::vector<hsize_t>& shape) {
  std::size_t count = 1;
  for (const hsize_t extent : shape) count *= extent;
  return count;
}

/// Read in the type of the file; the shape before them, and a colon.
inline std::string bytes_of_dataset(hid_t id) {
  const hdf5::Handle type(H5Dget_type(id), H5Tclose, "take the type");
  const std::vector<hsize_t> shape = shape_of(id);
  std::string bytes(count_of(shape) * H5Tget_size(type), '\0'), extents;
  if (!bytes.empty() && H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) bytes = "unreadable";
  for (const hsize_t extent : shape) extents += (extents.empty() ? "" : " x ") + std::to_string(extent);
  return extents + ":" + bytes;
}

inline std::vector<double> numbers(const fs::path& path, const std::string& name,
                                   std::vector<hsize_t>* shape = nullptr) {
  const hdf5::Handle file = opened(path), id = dataset(file, name);
  std::vector<double> values(count_of(shape_of(id)));
  if (shape != nullptr) *shape = shape_of(id);
  H5Dread(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  return values;
}

inline double number(const fs::path& path, const std::string& object, const std::string& attribute) {
  const hdf5::Handle file = opened(path);
  const hdf5::Handle id(H5Aopen_by_name(file, object.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                        "open " + attribute);
  double value = std::nan("");
  H5Aread(id, H5T_NATIVE_DOUBLE, &value);
  return value;
}

/// One text.
inline std::string text(const fs::path& path, const std::string& name) {
  const hdf5::Handle file = opened(path);
  return bytes_of_dataset(dataset(file, name)).substr(1);
}

struct Visit {
  FileContents& contents;
  std::string path, skipped;
};

inline herr_t on_attribute(hid_t object, const char* name, const H5A_info_t*, void* data) {
  const Visit& visit = *static_cast<Visit*>(data);
  const hdf5::Handle id(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, name), type(H5Aget_type(id), H5Tclose, name);
  std::string bytes(H5Aget_storage_size(id), '\0');
  if (H5Aread(id, type, bytes.data()) < 0) bytes = "unreadable";
  visit.contents[visit.path + "@" + name] = bytes;
  return 0;
}

inline herr_t on_object(hid_t root, const char* name, const H5O_info_t* info, void* data) {
  const Visit& file = *static_cast<Visit*>(data);
  if (name == file.skipped) return 0;
  const hdf5::Handle id(H5Oopen(root, name, H5P_DEFAULT), H5Oclose, name);
  file.contents[name] = info->type == H5O_TYPE_DATASET ? bytes_of_dataset(id) : "group";
  Visit visit{file.contents, name, {}};
  H5Aiterate2(id, H5_INDEX_NAME, H5_ITER_INC, nullptr, on_attribute, &visit);
  return 0;
}

}  // namespace h5

/// None when the file cannot be read; what describes how it came about is skipped.
inline FileContents contents_of(const fs::path& file, const std::string& skipped = "properties") {
  const hdf5::QuietScope quiet;
  FileContents contents;
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_GE(id, 0) << file << " cannot be read";
  if (id < 0) return contents;
  h5::Visit visit{contents, "", skipped};
  const herr_t status = H5Ovisit2(id, H5_INDEX_NAME, H5_ITER_INC, h5::on_object, &visit, H5O_INFO_BASIC);
  H5Fclose(id);
  EXPECT_GE(status, 0) << file << " cannot be read as a whole";
  return contents;
}

/// What differs between two files, by name; empty when every bit is the same.
inline std::string differences(const FileContents& a, const FileContents& b) {
  std::string text;
  for (const auto& [path, bytes] : a)
    if (b.count(path) == 0)
      text += path + " is missing\n";
    else if (b.at(path) != bytes)
      text += path + " differs\n";
  for (const auto& [path, bytes] : b)
    if (a.count(path) == 0) text += path + " is new\n";
  return text;
}

}  // namespace mixbeam
