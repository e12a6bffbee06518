#include "discretization/results/hdf5_writer.hpp"

#include <algorithm>

namespace mixbeam::hdf5 {
namespace {

constexpr hsize_t kMonitorChunkRows = 64;  // 512 bytes a column: small for short runs, few chunks for long ones

// Called from the innermost error outwards: keeps the first description, which is the cause.
herr_t keep_innermost(unsigned depth, const H5E_error2_t* error, void* reason) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(reason) = error->desc;
  return 0;
}

// The library's texts for failed system calls end in numbers of no use to a user; keep what the system said.
std::string system_message(const std::string& reason) {
  const std::string key = "error message = '";
  const auto start = reason.find(key);
  if (start == std::string::npos) return reason;
  const auto end = reason.find('\'', start + key.size());
  return end == std::string::npos ? reason : reason.substr(start + key.size(), end - start - key.size());
}

[[noreturn]] void fail(const std::string& action) {
  std::string reason = "no reason given by the HDF5 library";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &reason);
  throw Error("cannot " + action + ": " + system_message(reason));
}

void check(herr_t status, const std::string& action) {
  if (status < 0) fail(action);
}

Handle text_type(const std::string& text) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a text type");
  check(H5Tset_size(type, text.empty() ? 1 : text.size()), "size a text type");
  check(H5Tset_strpad(type, H5T_STR_NULLPAD), "pad a text type");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "mark a text type as UTF-8");
  return type;
}

Handle scalar_space() { return {H5Screate(H5S_SCALAR), H5Sclose, "make a scalar space"}; }

void write_scalar_attribute(hid_t object, const std::string& name, hid_t file_type, hid_t memory_type,
                            const void* value) {
  const std::string action = "write attribute " + name;
  const Handle space = scalar_space();
  const Handle attribute(H5Acreate2(object, name.c_str(), file_type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         action);
  check(H5Awrite(attribute, memory_type, value), action);
}

/// Without the time at which the dataset was made: the same results are the same bytes.
Handle dataset_creation() {
  Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties of a dataset");
  check(H5Pset_obj_track_times(creation, false), "make properties of a dataset");
  return creation;
}

void write_array(hid_t group, const std::string& name, const std::vector<hsize_t>& shape, hid_t file_type,
                 hid_t memory_type, const void* values) {
  const std::string action = "write dataset " + name;
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, action);
  const Handle dataset(H5Dcreate2(group, name.c_str(), file_type, space, H5P_DEFAULT, dataset_creation(), H5P_DEFAULT),
                       H5Dclose, action);
  check(H5Dwrite(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), action);
}

Handle create_extendible(hid_t group, const std::string& name, std::vector<hsize_t> shape) {
  const std::string action = "create time series " + name;
  const int rank = static_cast<int>(shape.size());
  shape[0] = kMonitorChunkRows;
  const Handle creation = dataset_creation();
  check(H5Pset_chunk(creation, rank, shape.data()), action);
  std::vector<hsize_t> limits = shape;
  shape[0] = 0;
  limits[0] = H5S_UNLIMITED;
  const Handle space(H5Screate_simple(rank, shape.data(), limits.data()), H5Sclose, action);
  return {H5Dcreate2(group, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose, action};
}

}  // namespace

// Every use of the library begins here. Files are closed one by one, with checks; where one cannot be closed, for it is
// damaged, the library would try for ever when the program ends.
QuietScope::QuietScope() {
  [[maybe_unused]] static const herr_t no_cleaning_at_exit = H5dont_atexit();
  H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietScope::~QuietScope() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

Handle::Handle(hid_t id, CloseFunction close_function, const std::string& action)
    : id_(id), close_function_(close_function) {
  if (id_ < 0) fail(action);
}

Handle::~Handle() { close(); }

void Handle::close() noexcept {
  if (id_ >= 0 && close_function_(std::exchange(id_, -1)) < 0) a_close_failed = true;
}

void require(herr_t status, const std::string& action) { check(status, action); }

Handle create_group(hid_t parent, const std::string& name) {
  return {H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "create group " + name};
}

Handle open_group(hid_t parent, const std::string& name) {
  return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, "open group " + name};
}

void write_attribute(hid_t object, const std::string& name, double value) {
  write_scalar_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void write_attribute(hid_t object, const std::string& name, int value) {
  write_scalar_attribute(object, name, H5T_STD_I32LE, H5T_NATIVE_INT, &value);
}

void write_attribute(hid_t object, const std::string& name, bool value) {
  write_attribute(object, name, value ? 1 : 0);
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  const Handle type = text_type(value);
  write_scalar_attribute(object, name, type, type, value.c_str());
}

void write_text(hid_t group, const std::string& name, const std::string& text) {
  const std::string action = "write text " + name;
  const Handle type = text_type(text);
  const Handle space = scalar_space();
  const Handle dataset(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, dataset_creation(), H5P_DEFAULT),
                       H5Dclose, action);
  check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), action);
}

void write_dataset(hid_t group, const std::string& name, const std::vector<double>& values, std::size_t columns) {
  std::vector<hsize_t> shape{values.size() / columns};
  if (columns > 1) shape.push_back(columns);
  write_array(group, name, shape, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data());
}

void write_dataset(hid_t group, const std::string& name, const std::vector<int>& values) {
  write_array(group, name, {values.size()}, H5T_STD_I32LE, H5T_NATIVE_INT, values.data());
}

void write_texts(hid_t group, const std::string& name, const std::vector<std::string>& texts) {
  std::size_t width = 1;
  for (const std::string& text : texts) width = std::max(width, text.size());
  const Handle type = text_type(std::string(width, ' '));
  std::string rows(width * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(&rows[width * i], texts[i].size());
  write_array(group, name, {texts.size()}, type, type, rows.data());
}

std::uint64_t place_dataset(hid_t parent, const std::string& name, bool integers, std::size_t rows,
                            std::size_t columns) {
  const std::string action = "create dataset " + name;
  std::vector<hsize_t> shape{rows};
  if (columns > 1) shape.push_back(columns);
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, action);
  const Handle creation = dataset_creation();
  check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), action);
  check(H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER), action);
  const Handle dataset(H5Dcreate2(parent, name.c_str(), integers ? H5T_STD_I32LE : H5T_IEEE_F64LE, space, H5P_DEFAULT,
                                  creation, H5P_DEFAULT),
                       H5Dclose, action);
  if (rows == 0) return 0;
  const haddr_t offset = H5Dget_offset(dataset);
  if (offset == HADDR_UNDEF) fail(action);
  return offset;
}

void append_rows(hid_t group, const std::string& name, const std::vector<double>& rows, std::size_t columns) {
  const std::string action = "append to time series " + name;
  const bool exists = has_link(group, name);
  std::vector<hsize_t> shape{0};
  if (columns > 1) shape.push_back(columns);
  const Handle dataset = exists ? Handle(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, action)
                                : create_extendible(group, name, shape);
  {
    const Handle space(H5Dget_space(dataset), H5Sclose, action);
    check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), action);
  }
  std::vector<hsize_t> start(shape.size(), 0);
  start[0] = shape[0];
  std::vector<hsize_t> count = shape;
  count[0] = rows.size() / columns;
  if (count[0] == 0) return;
  shape[0] += count[0];
  check(H5Dset_extent(dataset, shape.data()), action);
  const Handle target(H5Dget_space(dataset), H5Sclose, action);
  check(H5Sselect_hyperslab(target, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), action);
  const Handle source(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose, action);
  check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, source, target, H5P_DEFAULT, rows.data()), action);
}

void remove_link(hid_t parent, const std::string& name) {
  check(H5Ldelete(parent, name.c_str(), H5P_DEFAULT), "remove " + name);
}

bool has_link(hid_t group, const std::string& name) {
  const htri_t exists = H5Lexists(group, name.c_str(), H5P_DEFAULT);
  if (exists < 0) fail("look for " + name);
  return exists > 0;
}

std::size_t count_links(hid_t group) {
  H5G_info_t info;
  check(H5Gget_info(group, &info), "count the entries of a group");
  return info.nlinks;
}

std::vector<std::string> link_names(hid_t group) {
  std::vector<std::string> names(count_links(group));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto name_of = [&](char* text, std::size_t size) {
      return H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, text, size, H5P_DEFAULT);
    };
    const auto length = name_of(nullptr, 0);
    if (length < 0) fail("read the names in a group");
    names[i].resize(static_cast<std::size_t>(length) + 1);
    name_of(names[i].data(), names[i].size());
    names[i].resize(static_cast<std::size_t>(length));
  }
  return names;
}

std::vector<std::string> attribute_names(hid_t object) {
  const auto keep = [](hid_t, const char* name, const H5A_info_t*, void* names) -> herr_t {
    static_cast<std::vector<std::string>*>(names)->push_back(name);
    return 0;
  };
  std::vector<std::string> names;
  check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep, &names), "read the names of attributes");
  return names;
}

double read_number(hid_t object, const std::string& attribute) {
  const std::string action = "read attribute " + attribute;
  const Handle id(H5Aopen(object, attribute.c_str(), H5P_DEFAULT), H5Aclose, action);
  double value = 0.0;
  check(H5Aread(id, H5T_NATIVE_DOUBLE, &value), action);
  return value;
}

std::string read_text_attribute(hid_t object, const std::string& attribute) {
  const std::string action = "read attribute " + attribute;
  const Handle id(H5Aopen(object, attribute.c_str(), H5P_DEFAULT), H5Aclose, action);
  const Handle type(H5Aget_type(id), H5Tclose, action);
  std::string text(H5Tget_size(type), '\0');
  check(H5Aread(id, type, text.data()), action);
  return text.c_str();  // an empty text is stored as one zero
}

void read_attribute(hid_t object, const std::string& name, double& value) { value = read_number(object, name); }
void read_attribute(hid_t object, const std::string& name, int& value) {
  value = static_cast<int>(read_number(object, name));
}
void read_attribute(hid_t object, const std::string& name, bool& value) { value = read_number(object, name) != 0.0; }
void read_attribute(hid_t object, const std::string& name, std::string& value) {
  value = read_text_attribute(object, name);
}

bool has_attribute(hid_t object, const std::string& name) {
  const auto names = attribute_names(object);
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string read_text(hid_t group, const std::string& name) {
  const std::string action = "read text " + name;
  const Handle id(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, action);
  const Handle type(H5Dget_type(id), H5Tclose, action);
  std::string text(H5Tget_size(type), '\0');
  check(H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), action);
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::vector<std::string> read_texts(hid_t group, const std::string& name) {
  const std::string action = "read texts " + name;
  const Handle id(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, action);
  const Handle type(H5Dget_type(id), H5Tclose, action), space(H5Dget_space(id), H5Sclose, action);
  const auto count = H5Sget_simple_extent_npoints(space);
  if (count < 0 || H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) fail(action);
  const std::size_t width = H5Tget_size(type);
  std::string rows(width * static_cast<std::size_t>(count), '\0');
  check(H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()), action);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < rows.size(); i += width) {
    texts.push_back(rows.substr(i, width));
    texts.back().resize(std::min(width, texts.back().find('\0')));
  }
  return texts;
}

void read_attributes(hid_t object) {
  for (const std::string& name : attribute_names(object)) {
    const std::string action = "read attribute " + name;
    const Handle id(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, action);
    const Handle type(H5Aget_type(id), H5Tclose, action);
    std::vector<char> bytes(H5Aget_storage_size(id) + H5Tget_size(type));
    check(H5Aread(id, type, bytes.data()), action);
  }
}

void read_all(hid_t group, const std::string& dataset) {
  const std::string action = "read dataset " + dataset;
  const Handle id(H5Dopen2(group, dataset.c_str(), H5P_DEFAULT), H5Dclose, action);
  const Handle type(H5Dget_type(id), H5Tclose, action), space(H5Dget_space(id), H5Sclose, action);
  const auto points = H5Sget_simple_extent_npoints(space);
  if (points < 0) fail(action);
  std::vector<char> bytes(static_cast<std::size_t>(points) * H5Tget_size(type));
  check(H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), action);
}

bool is_group(hid_t parent, const std::string& name) {
  H5O_info_t info;
  check(H5Oget_info_by_name2(parent, name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT), "open " + name);
  return info.type == H5O_TYPE_GROUP;
}

std::pair<std::uint64_t, std::uint64_t> data_place(hid_t group, const std::string& dataset) {
  const Handle id(H5Dopen2(group, dataset.c_str(), H5P_DEFAULT), H5Dclose, "open dataset " + dataset);
  const haddr_t offset = H5Dget_offset(id);
  if (offset == HADDR_UNDEF) return {0, 0};
  return {offset, H5Dget_storage_size(id)};
}

std::vector<double> read_dataset(hid_t group, const std::string& name, std::size_t* columns) {
  const std::string action = "read dataset " + name;
  const Handle id(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, action);
  const Handle space(H5Dget_space(id), H5Sclose, action);
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(1, H5Sget_simple_extent_ndims(space))), 0);
  check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), action);
  if (columns != nullptr) *columns = shape.size() > 1 ? static_cast<std::size_t>(shape[1]) : 1;
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  check(H5Dread(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), action);
  return values;
}

}  // namespace mixbeam::hdf5
